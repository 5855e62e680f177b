// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/vectorize_video.h"

#include "cli/command.h"
#include "cli/file_names.h"

namespace knotreel::cli {

void add_vectorize_video_options(CLI::App& command, VideoRun& run) {
  command.option_defaults()->group(kVideoGroup);
  add_split_option(command, run.split_folder);
  add_progress_option(command, run.progress);
  add_trace_option(command, run.trace);
  add_tracking_options(command, run.tracking, run.no_drawn_frames);
  add_video_input_options(command, run.reading);
  command.option_defaults()->group("Options");
}

void vectorize_video(VideoRun run) {
  run.reading.no_copy_streams = true;  // there is no place for them in a document
  if (run.split_folder.empty()) warn_of_numbered_document(run.document);
  const pipeline::Summary summary = run_video(run);
  if (!uses_standard_output(outputs_of(run))) {
    tell_result(summary_text(run.document.empty() ? run.split_folder : run.document, summary));
  }
  check_stopped(summary);
}

}  // namespace knotreel::cli
