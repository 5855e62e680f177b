// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/part_options.h"

#include "cli/parse.h"

namespace knotreel::cli {

void add_part_options(CLI::App& command, PartOptions& options, const std::string& frames_help) {
  CLI::Option* frames = command.add_option("--frames", options.frames, frames_help)->type_name("A-B");
  command
      .add_option(
          "--start", options.start,
          "Only frames from this time on, counted from the first frame, in seconds\nor as [HH:]MM:SS.S")
      ->type_name("TIME")
      ->excludes(frames);
  command.add_option("--end", options.end, "Only frames before this time")
      ->type_name("TIME")
      ->excludes(frames);
}

video::Part part_of(const PartOptions& given) {
  video::Part part;
  if (!given.frames.empty()) {
    const FrameRange range = parse_frames(given.frames);
    part.first = range.first;
    if (range.last) part.count = *range.last - range.first + 1;
  }
  if (!given.start.empty()) part.start = parse_time("--start", given.start);
  if (!given.end.empty()) part.end = parse_time("--end", given.end);
  if (part.end <= part.start) refuse("--end", given.end, "a time behind the start");
  return part;
}

}  // namespace knotreel::cli
