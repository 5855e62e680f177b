// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/compare_videos.h"

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "cli/command.h"
#include "cli/frame_source.h"
#include "cli/interrupt.h"
#include "cli/metrics_report.h"
#include "cli/video_options.h"
#include "knotreel/base/error.h"
#include "knotreel/base/output_file.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/metrics.h"
#include "knotreel/motion/flow.h"
#include "knotreel/motion/luma.h"
#include "knotreel/motion/measures.h"

namespace knotreel::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Figures of all frames so far, and where things move in the reference.
class Comparison {
 public:
  void add(const image::Image& reference, const image::Image& result) {
    const image::ImageMetrics metrics = image::compare_images(reference, result);
    motion::Luma luma = motion::luma_of(reference);
    const bool alpha = reference.has_alpha() || result.has_alpha();
    const int channels = std::max(reference.colour_channels(), result.colour_channels()) + (alpha ? 1 : 0);
    const image::Image a = image::widen_channels(reference, channels);
    const image::Image b = image::widen_channels(result, channels);
    if (luma_.v.empty()) {
      flicker_.add(a, b);
    } else {
      const motion::FlowPair flow = motion::find_flow_pair(luma_, luma);
      flicker_.add(a, b, &flow.forward, &flow.consistent);
    }
    luma_ = std::move(luma);
    rows_.push_back(metrics);
  }

  std::size_t frames() const { return rows_.size(); }
  double flicker() const { return flicker_.flicker(); }
  double warped_flicker() const { return flicker_.warped_flicker(); }

  /// Means; RMSE and PSNR are those of the mean squared error.
  image::ImageMetrics pooled() const {
    image::ImageMetrics all;
    double squares = 0;
    double noise = 0;
    for (const image::ImageMetrics& m : rows_) {
      all.mec += m.mec;
      all.ssim += m.ssim;
      squares += m.rmse * m.rmse;
      noise += std::pow(10.0, -m.psnr / 10);
    }
    const double n = static_cast<double>(rows_.size());
    return {.mec = all.mec / n,
            .rmse = std::sqrt(squares / n),
            .psnr = -10 * std::log10(noise / n),
            .ssim = all.ssim / n};
  }

  Json rows_json() const {
    Json rows = Json::array();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      Json row{{"frame", i}};
      row.update(metrics_json(rows_[i]));
      row["flicker"] = i == 0 ? Json(nullptr) : Json(flicker_.per_frame()[i - 1]);
      // Not a number becomes null.
      row["warped_flicker"] = i == 0 ? Json(nullptr) : Json(flicker_.warped_per_frame()[i - 1]);
      rows.push_back(std::move(row));
    }
    return rows;
  }

 private:
  std::vector<image::ImageMetrics> rows_;
  motion::FlickerMeter flicker_;
  motion::Luma luma_;
};

/// @return the size of the frames.
std::pair<int, int> compare_all(FrameSource& reference, FrameSource& result, Comparison& comparison) {
  std::pair<int, int> size;
  while (true) {
    check_interrupted();
    image::Image a, b;
    const bool more_a = reference.next(a), more_b = result.next(b);
    if (more_a != more_b) {
      warn(fmt::format("the {} video has more frames; only the first {} are compared",
                       more_a ? "first" : "second", comparison.frames()));
    }
    if (!more_a || !more_b) return size;
    comparison.add(a, b);
    size = {a.width, a.height};
  }
}

Json figures_json(const Comparison& comparison, std::pair<int, int> size) {
  Json json{{"width", size.first}, {"height", size.second}, {"frames", comparison.frames()}};
  json.update(metrics_json(comparison.pooled()));
  json["flicker"] = comparison.flicker();
  json["warped_flicker"] = comparison.warped_flicker();
  return json;
}

std::string figures_text(const Comparison& comparison, std::pair<int, int> size) {
  const image::ImageMetrics all = comparison.pooled();
  return fmt::format(
      "size            {}x{}\n"
      "frames          {}\n"
      "MEC             {:.3f}   mean length of the colour error, 0..255 (0 is equal)\n"
      "RMSE            {:.5f}   root mean square error, colour in 0..1 (0 is equal)\n"
      "PSNR            {}   on 8 bits, of the mean error (more is better)\n"
      "SSIM            {:.5f}   structural similarity (1 is equal)\n"
      "flicker         {:.3f}   change in B that is not in A, levels per frame (0 is none)\n"
      "warped flicker  {:.3f}   the same along the motion\n",
      size.first, size.second, comparison.frames(), all.mec, all.rmse, psnr_text(all.psnr), all.ssim,
      comparison.flicker(), comparison.warped_flicker());
}

}  // namespace

void compare_videos(const CompareVideos& arguments) {
  const ThreadCap cap(arguments.threads);
  video::ReadOptions reading;
  reading.threads = arguments.threads;
  reading.deinterlace = deinterlace_mode(arguments.deinterlace);
  const auto result = open_frames(arguments.result, reading);
  reading.filter = arguments.filter;
  const auto reference = open_frames(arguments.reference, reading);
  std::optional<OutputFile> stats;
  if (!arguments.stats.empty()) stats.emplace(arguments.stats);  // first: better to fail before the work
  Comparison comparison;
  const auto size = compare_all(*reference, *result, comparison);
  if (comparison.frames() == 0) throw Error(ErrorKind::kInput, "there are no frames to compare");
  warn_of(arguments.reference, reference->warnings());
  warn_of(arguments.result, result->warnings());
  Json json = figures_json(comparison, size);
  if (stats) {
    json["rows"] = comparison.rows_json();
    stats->write(json.dump(2) + "\n");
    stats->commit();
    json.erase("rows");
  }
  if (arguments.stats == "-") return;
  write_text("-", arguments.json ? json.dump(2) + "\n" : figures_text(comparison, size));
}

}  // namespace knotreel::cli
