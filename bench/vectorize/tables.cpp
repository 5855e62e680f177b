// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/tables.h"

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <sstream>

#include "knotreel/document/writer.h"
#include "knotreel/image/metrics.h"
#include "knotreel/raster/render.h"

namespace knotreel::bench {

namespace {

using vectorize::Options;

std::size_t share_of(const image::Image& picture, double share) {
  return static_cast<std::size_t>(share * static_cast<double>(picture.pixel_count()));
}

/// Encodes a model and gives back what is stored.
document::FrameModel stored(const image::Image& picture, const document::FrameModel& model,
                            std::size_t& bytes) {
  document::SequenceInfo info;
  info.width = picture.width;
  info.height = picture.height;
  info.channels = picture.channels;
  info.degree = model.space->degree();
  std::ostringstream out;
  document::Writer writer(out, info, {.rename_knots = true});
  document::FrameModel result = writer.append(model);
  writer.finish();
  bytes = out.str().size();
  return result;
}

double psnr_of(const image::Image& a, const image::Image& b, const std::vector<std::uint8_t>& near) {
  const auto channels = static_cast<std::size_t>(a.channels);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.pixel_count(); ++i) {
    if (near.empty() || !near[i]) continue;
    for (std::size_t c = 0; c < channels; ++c) {
      const double d = std::round(static_cast<double>(a.samples[i * channels + c])) -
                       std::clamp(std::round(static_cast<double>(b.samples[i * channels + c])), 0.0, 255.0);
      sum += d * d;
      ++count;
    }
  }
  return sum > 0 ? 10 * std::log10(255.0 * 255.0 * static_cast<double>(count) / sum) : 0;
}

/// Pixels within two of a feature.
std::vector<std::uint8_t> near_features(const image::Image& picture, const features::FeatureChains& chains) {
  std::vector<std::uint8_t> near(picture.pixel_count(), 0);
  for (const auto& chain : chains.chains) {
    for (const auto& p : chain.points) {
      for (int y = std::max(0, p.y - 2); y <= std::min(picture.height - 1, p.y + 2); ++y) {
        for (int x = std::max(0, p.x - 2); x <= std::min(picture.width - 1, p.x + 2); ++x) {
          near[std::size_t(y) * std::size_t(picture.width) + std::size_t(x)] = 1;
        }
      }
    }
  }
  return near;
}

/// The linear mesh with about as many bytes: the number of control points is found by its own ratio.
Outcome linear_at(const image::Image& picture, std::size_t raw_bytes) {
  Options options = vectorize::preset_options(vectorize::Preset::kBalanced);
  options.degree = 1;
  options.features = false;
  options.max_control_points = raw_bytes / 40;  // 20 per control point, 8 per knot, two triangles of 6
  return measure(picture, options);
}

struct Variant {
  const char* name;
  void (*change)(Options&);
};

}  // namespace

Outcome measure(const image::Image& picture, const Options& options, const std::vector<std::uint8_t>& near) {
  const auto start = std::chrono::steady_clock::now();
  vectorize::Vectorization result = vectorize::vectorize_picture(picture, options);
  Outcome outcome;
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const document::FrameModel model = stored(picture, result.model, outcome.file_bytes);
  const image::Image rendered{picture.width, picture.height, picture.channels, raster::render(model)};
  const image::ImageMetrics metrics = image::compare_images(picture, rendered);
  outcome.psnr = metrics.psnr;
  outcome.mec = metrics.mec;
  outcome.psnr_edges = psnr_of(picture, rendered, near);
  outcome.control_points = model.space->function_count();
  outcome.raw_bytes = document::raw_accounting_bytes(model);
  outcome.report = std::move(result.report);
  return outcome;
}

void print_curves(const std::vector<Picture>& pictures) {
  fmt::print(
      "| picture | control points | PSNR | without features | linear mesh, equal bytes | raw bytes | file "
      "bytes |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const Picture& p : pictures) {
    for (const double share : {0.005, 0.01, 0.02, 0.04}) {
      Options options = vectorize::preset_options(vectorize::Preset::kBalanced);
      options.max_control_points = share_of(p.image, share);
      options.mec = 0;
      const Outcome with = measure(p.image, options);
      options.features = false;
      const Outcome without = measure(p.image, options);
      const Outcome linear = linear_at(p.image, without.raw_bytes);
      fmt::print("| {} | {} ({} %) | {:.2f} | {:.2f} | {:.2f} | {} | {} |\n", p.name, with.control_points,
                 100 * share, with.psnr, without.psnr, linear.psnr, with.raw_bytes, with.file_bytes);
      std::fflush(stdout);
    }
  }
}

void print_presets(const std::vector<Picture>& pictures) {
  fmt::print(
      "| picture | preset | PSNR | MEC | control points | raw bytes | file bytes | seconds |\n"
      "|---|---|---|---|---|---|---|---|\n");
  constexpr std::pair<const char*, vectorize::Preset> kPresets[] = {
      {"fast", vectorize::Preset::kFast},
      {"balanced", vectorize::Preset::kBalanced},
      {"fine", vectorize::Preset::kFine}};
  for (const auto& [name, preset] : kPresets) {
    double mean = 0;
    double seconds = 0;
    for (const Picture& p : pictures) {
      const Outcome o = measure(p.image, vectorize::preset_options(preset));
      mean += o.psnr;
      seconds += o.seconds;
      fmt::print("| {} | {} | {:.2f} | {:.2f} | {} | {} | {} | {:.2f} |\n", p.name, name, o.psnr, o.mec,
                 o.control_points, o.raw_bytes, o.file_bytes, o.seconds);
      std::fflush(stdout);
    }
    const auto n = static_cast<double>(pictures.size());
    fmt::print("| mean | {} | {:.2f} | | | | | {:.2f} |\n", name, mean / n, seconds / n);
  }
}

void print_ablation(const std::vector<Picture>& pictures) {
  const Variant variants[] = {
      {"all of it", [](Options&) {}},
      {"Euclidean gradient magnitude", [](Options& o) { o.detect.euclidean_magnitude = true; }},
      {"no fairing", [](Options& o) { o.fairing = false; }},
      {"no colour correction", [](Options& o) { o.colour_correction = false; }},
      {"no knot optimisation", [](Options& o) { o.optimise.positions = o.optimise.connectivity = false; }},
      {"positions only", [](Options& o) { o.optimise.connectivity = false; }},
      {"connectivity only", [](Options& o) { o.optimise.positions = false; }},
      {"no links from the picture", [](Options& o) { o.picture_links = false; }},
      {"no refinement rounds", [](Options& o) { o.rounds = 1; }},
      {"no descent on the residual", [](Options& o) { o.descent_steps = 0; }},
      {"no corner smoothing", [](Options& o) { o.colour.smooth_corners = false; }},
      {"no features", [](Options& o) { o.features = false; }},
  };
  std::vector<std::vector<std::uint8_t>> near;
  for (const Picture& p : pictures) {
    near.push_back(near_features(p.image, features::detect_features(p.image, Options{}.detect)));
  }
  fmt::print("| | PSNR | near features | raw bytes |\n|---|---|---|---|\n");
  for (const Variant& v : variants) {
    double psnr = 0;
    double edges = 0;
    double bytes = 0;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      Options options = vectorize::preset_options(vectorize::Preset::kBalanced);
      options.max_control_points = vectorize::default_control_points(pictures[i].image);
      v.change(options);
      const Outcome o = measure(pictures[i].image, options, near[i]);
      psnr += o.psnr;
      edges += o.psnr_edges;
      bytes += static_cast<double>(o.raw_bytes);
    }
    const auto n = static_cast<double>(pictures.size());
    fmt::print("| {} | {:.2f} | {:.2f} | {:.0f} |\n", v.name, psnr / n, edges / n, bytes / n);
    std::fflush(stdout);
  }
}

void print_stages(const std::vector<Picture>& pictures) {
  for (const Picture& p : pictures) {
    const Outcome o = measure(p.image, vectorize::preset_options(vectorize::Preset::kBalanced));
    fmt::print(
        "{} ({} x {}, {} control points): {:.0f} ms in all, PSNR {:.2f}\n\n| round | stages, ms | PSNR | MEC "
        "|\n"
        "|---|---|---|---|\n",
        p.name, p.image.width, p.image.height, o.control_points, 1e3 * o.seconds, o.psnr);
    for (const auto& r : o.report.rounds) {
      std::string stages;
      for (const auto& [name, ms] : r.milliseconds) {
        if (!stages.empty()) stages += ", ";
        stages += fmt::format("{} {:.0f}", name, ms);
      }
      fmt::print("| {} | {} | {:.2f} | {:.2f} |\n", r.name, stages, r.psnr, r.mec);
    }
    fmt::print("\n");
  }
}

void print_scaling(const std::vector<Picture>& pictures) {
  fmt::print("| picture | pixels | control points | seconds | us per pixel |\n|---|---|---|---|---|\n");
  const auto row = [](const std::string& name, const image::Image& image, std::size_t control_points) {
    Options options = vectorize::preset_options(vectorize::Preset::kBalanced);
    options.mec = 0;
    options.max_control_points = control_points;
    const Outcome o = measure(image, options);
    fmt::print("| {} | {} | {} | {:.2f} | {:.2f} |\n", name, image.pixel_count(), o.control_points, o.seconds,
               1e6 * o.seconds / static_cast<double>(image.pixel_count()));
    std::fflush(stdout);
  };
  for (const Picture& p : pictures) {
    for (const double share : {0.005, 0.01, 0.02, 0.04}) row(p.name, p.image, share_of(p.image, share));
    for (const int times : {1, 2, 4}) {  // side by side, so that there is as much to see per pixel
      image::Image tiled = image::make_image(p.image.width * times, p.image.height, p.image.channels);
      for (int y = 0; y < tiled.height; ++y) {
        for (int t = 0; t < times; ++t) {
          std::copy(p.image.row(y).begin(), p.image.row(y).end(),
                    tiled.row(y).begin() + static_cast<std::ptrdiff_t>(p.image.row_size()) * t);
        }
      }
      row(fmt::format("{} x {}", times, p.name), tiled, share_of(tiled, 0.02));
    }
  }
}

}  // namespace knotreel::bench
