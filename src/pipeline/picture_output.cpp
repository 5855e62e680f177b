// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/picture_output.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "knotreel/spline/pixel_tiles.h"

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

void copy_tiles(const image::Image& from, std::span<const std::uint8_t> tiles, image::Image& to) {
  constexpr int kSide = spline::PixelTiles::kSide;
  const int columns = (from.width + kSide - 1) / kSide;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    if (!tiles[t]) continue;
    const int x = static_cast<int>(t) % columns * kSide;
    const int y = static_cast<int>(t) / columns * kSide;
    const auto count = static_cast<std::size_t>(std::min(kSide, from.width - x) * from.channels);
    for (int row = y; row < std::min(y + kSide, from.height); ++row) {
      const std::size_t first =
          static_cast<std::size_t>(row) * from.row_size() + static_cast<std::size_t>(x * from.channels);
      std::copy_n(from.samples.begin() + static_cast<std::ptrdiff_t>(first), count,
                  to.samples.begin() + static_cast<std::ptrdiff_t>(first));
    }
  }
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

/// Whether what is written is the model at its own size, and has changed in parts.
bool PictureOutput::draws_changes(const Message& message) const {
  return !message.changed.empty() && message.picture && same_size_ && !message.picture->has_alpha();
}

void PictureOutput::draw(Message& message, const BasisPointer& basis) const {
  if (draws_changes(message)) {
    message.rendering = raster::Renderer::in_tiles(message.model, basis, message.surface, message.changed);
    return;
  }
  if (message.picture) {
    image::Image own = rendered(message, basis, {});
    measure(*message.picture, own, measured_, message.row);
    if (same_size_ && (writer_ || !own.has_alpha())) message.rendering = std::move(own);
  }
  if (writer_ && message.rendering.samples.empty()) message.rendering = rendered(message, basis, at_output_);
  message.rendering = image::on_background(std::move(message.rendering), background_);
}

void PictureOutput::write(Message& message) {
  FrameRow& row = message.row;
  if (message.repeats) {
    std::tie(row.mec, row.meg, row.psnr, row.ssim) = figures_;
  } else {
    if (draws_changes(message)) {
      copy_tiles(message.rendering, message.changed, written_);
      measure(*message.picture, written_, measured_, row);
    } else {
      written_ = std::move(message.rendering);
    }
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
