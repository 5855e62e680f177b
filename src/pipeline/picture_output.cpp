// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/picture_output.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace knotreel::pipeline {
namespace {

using BasisPointer = std::shared_ptr<const spline::Basis>;

image::Image rendered(const Message& message, const BasisPointer& basis,
                      const raster::RenderOptions& options) {
  return raster::Renderer(message.model, options, basis, message.surface).whole();
}

void measure(const image::Image& picture, const image::Image& rendering, image::Figures figures,
             FrameRow& row) {
  const image::ImageMetrics metrics = image::compare_images(picture, rendering, figures);
  row.mec = metrics.mec;
  row.psnr = metrics.psnr;
  row.ssim = metrics.ssim;
}

double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

}  // namespace

PictureOutput::PictureOutput(const VideoOutput& output, const video::StreamInfo& source,
                             const video::VideoReader* copied, FrameObserver on_frame, image::Figures figures)
    : measured_(figures), background_(output.background), on_frame_(std::move(on_frame)) {
  video::StreamInfo frames = source;
  if (output.width > 0) frames.width = output.width;
  if (output.height > 0) frames.height = output.height;
  if (output.depth > 0) frames.depth = output.depth;
  frames.sample_aspect = video::sample_aspect_at(source, frames.width, frames.height);
  same_size_ = output.antialias && frames.width == source.width && frames.height == source.height;
  at_output_.width = frames.width;
  at_output_.height = frames.height;
  at_output_.antialias = output.antialias;
  if (output.crop) {
    same_size_ = false;
    at_output_.crop_x = output.crop->x;
    at_output_.crop_y = output.crop->y;
    at_output_.crop_width = frames.width = output.crop->width;
    at_output_.crop_height = frames.height = output.crop->height;
  }
  frames.channels = image::channels_on(background_, frames.channels);
  if (output.path.empty()) return;
  writer_.emplace(video::VideoWriter::create(output.path, frames, output.options, copied));
}

void PictureOutput::draw(Message& message, const BasisPointer& basis) const {
  if (message.picture) {
    image::Image own = rendered(message, basis, {});
    measure(*message.picture, own, measured_, message.row);
    if (writer_ && same_size_) message.rendering = std::move(own);
  }
  if (writer_ && message.rendering.samples.empty()) message.rendering = rendered(message, basis, at_output_);
  message.rendering = image::on_background(std::move(message.rendering), background_);
}

void PictureOutput::write(Message& message) {
  FrameRow& row = message.row;
  if (message.repeats) {
    std::tie(row.mec, row.meg, row.psnr, row.ssim) = figures_;
  } else {
    written_ = std::move(message.rendering);
    figures_ = {row.mec, row.meg, row.psnr, row.ssim};
  }
  if (!writer_) return;
  writer_->write_packets(message.frame.packets);
  writer_->write(written_, message.frame.pts, message.frame.duration);
}

void PictureOutput::write_packets(const std::vector<video::Packet>& packets) {
  if (writer_) writer_->write_packets(packets);
}

void PictureOutput::sum_up(FrameRow& row) {
  for (const StageSpan& span : row.spans) {
    if (span.stage == "model") row.modelled_seconds = seconds_between(start_, span.end);
  }
  row.finished_seconds = seconds_between(start_, Clock::now());
  if (sums_.frames == 0) sums_.first_frame_seconds = row.finished_seconds;
  ++sums_.frames;
  squared_error_ += std::pow(10.0, -row.psnr / 10);
  sums_.mec += row.mec;
  sums_.meg += row.meg;
  sums_.ssim += row.ssim;
  sums_.knots += static_cast<double>(row.knots);
  sums_.control_points += static_cast<double>(row.control_points);
  if (row.start == track::to_string(track::Start::kWarm)) {
    sums_.survival += row.survival;
  } else if (!row.start.empty()) {
    ++sums_.keyframes;
  }
  warn_of_small_text(row);
  warn_of_dropped_features(row);
  if (on_frame_) on_frame_(row);
}

/// Once.
void PictureOutput::warn_of_small_text(const FrameRow& row) {
  constexpr double kLegible = 26;  // dB
  if (row.wanted_share == 0 || row.psnr >= kLegible || std::exchange(told_of_text_, true)) return;
  const auto percent = static_cast<int>(10 * std::ceil(10 * row.wanted_share));
  sums_.warnings.push_back("frame " + std::to_string(row.index) + " is a drawing with more edges than its " +
                           std::to_string(row.control_points) +
                           " control points can show, such as small text; --max-control-points " +
                           std::to_string(percent) + "% makes them sharper, but takes many times as long");
}

/// Once.
void PictureOutput::warn_of_dropped_features(const FrameRow& row) {
  if (!row.features_dropped || std::exchange(told_of_features_, true)) return;
  sums_.warnings.push_back("the features of frame " + std::to_string(row.index) +
                           " make no mesh that can be stored; it is made without");
}

Summary PictureOutput::finish() {
  if (writer_) {
    writer_->finish();
    sums_.digest = writer_->digest();
    const std::vector<std::string> warnings = writer_->warnings();
    sums_.warnings.insert(sums_.warnings.begin(), warnings.begin(), warnings.end());
  }
  Summary summary = sums_;
  summary.seconds = seconds_between(start_, Clock::now());
  summary.cpu_seconds = static_cast<double>(std::clock() - cpu_start_) / CLOCKS_PER_SEC;
  if (summary.frames == 0) return summary;
  const double n = static_cast<double>(summary.frames);
  const double warm = n - static_cast<double>(summary.keyframes);
  summary.fps = n / summary.seconds;
  summary.psnr = -10 * std::log10(squared_error_ / n);
  for (double* sum : {&summary.mec, &summary.meg, &summary.ssim, &summary.knots, &summary.control_points})
    *sum /= n;
  if (warm > 0) summary.survival /= warm;
  return summary;
}

}  // namespace knotreel::pipeline
