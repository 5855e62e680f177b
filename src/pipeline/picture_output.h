// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <ctime>
#include <optional>
#include <tuple>

#include "knotreel/image/metrics.h"
#include "knotreel/pipeline/job.h"
#include "knotreel/raster/render.h"
#include "pipeline/message.h"

namespace knotreel::pipeline {

using Clock = std::chrono::steady_clock;

/// The end of the way that all jobs share: models are drawn, and the pictures written and summed up.
class PictureOutput {
 public:
  /// @param copied  whose other streams are copied; may be null. @throws as VideoWriter::create().
  PictureOutput(const VideoOutput& output, const video::StreamInfo& source, const video::VideoReader* copied,
                FrameObserver on_frame, image::Figures figures);

  /// Draws the model at the size of the output, or what has changed of it; measures it at its own size if the
  /// message has the picture, and all was drawn. Several messages at once.
  /// @param basis of the space of the model.
  void draw(Message& message, const std::shared_ptr<const spline::Basis>& basis) const;

  /// Writes what was drawn, or once more what was written last, with its figures, if the message repeats
  /// that, or with what has changed; in order, one at a time.
  void write(Message& message);
  void write_packets(const std::vector<video::Packet>& packets);

  /// Adds the row to the summary and shows it to the caller; in order, one at a time.
  void sum_up(FrameRow& row);

  /// Completes the file.
  Summary finish();

 private:
  bool draws_changes(const Message& message) const;
  void warn_of_small_text(const FrameRow& row);
  void warn_of_dropped_features(const FrameRow& row);

  raster::RenderOptions at_output_;
  std::optional<video::VideoWriter> writer_;
  image::Image written_;                                ///< last, or drawn last if there is no writer
  std::tuple<double, double, double, double> figures_;  ///< of it: MEC, MEG, PSNR, SSIM
  bool same_size_ = false;
  image::Figures measured_;
  image::Background background_;
  FrameObserver on_frame_;
  Clock::time_point start_ = Clock::now();
  std::clock_t cpu_start_ = std::clock();
  Summary sums_;
  double squared_error_ = 0;
  bool told_of_text_ = false;
  bool told_of_features_ = false;
};

}  // namespace knotreel::pipeline
