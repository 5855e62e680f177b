// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cli/bench/scratch.h"
#include "cli/parse.h"
#include "knotreel/video/writer.h"

namespace knotreel::cli::bench {

/// What is measured.
struct Clip {
  std::string name;  ///< for reports
  std::string path;
  int width = 0;   ///< pixels
  int height = 0;  ///< see width
};

/// Makes ready what a clip of the command line asks for, so that neither scaling nor cutting is in the time.
/// @param wanted a file, or one of media::bench_clip_names(), which is drawn and stored without loss.
/// @param size   of a file: it is brought to that size and stored with hardly any loss; none: as it is.
/// @param frames of a file: the first ones are stored likewise; 0: all.
/// @throws Error as VideoReader and VideoWriter, Error{kInterrupted} after a signal.
Clip prepare_clip(const std::string& wanted, const std::optional<Size>& size, std::uint64_t frames,
                  const Scratch& scratch);

/// Decodes a clip and encodes it again and does nothing in between: no transcoder with the same reader and
/// writer can be faster. With more than one thread both are done at the same time.
/// @return seconds, on the clock of pipeline::Summary: from when the reader is open until the file is whole.
double pass_through(const std::string& input, const std::string& output, const video::WriteOptions& options,
                    int threads);

}  // namespace knotreel::cli::bench
