// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "knotreel/vectorize/vectorize.h"

namespace knotreel::cli::debug {

/// Writes what every stage made as PNG pictures into a folder; docs/stats.md lists them. Stages that did not
/// take place leave none.
class DebugPictures {
 public:
  /// Makes the folder if it is missing. @throws Error{kOutput}.
  explicit DebugPictures(std::filesystem::path folder);

  /// To be called as, or by, vectorize::Observer. @throws Error{kOutput}.
  void write(const vectorize::Progress& progress);

  /// Of the model as it was stored; the last picture.
  void write_control_net(const image::Image& picture, const document::FrameModel& model);

  /// All that there is to see of a model as it was stored, under names without numbers.
  void write_stored(const image::Image& picture, const document::FrameModel& model);

 private:
  std::filesystem::path next(const std::string& name);
  void write_round(const vectorize::Progress& progress);

  std::filesystem::path folder_;
  int number_ = 6;  ///< of the next picture after the five of the preparation
};

}  // namespace knotreel::cli::debug
