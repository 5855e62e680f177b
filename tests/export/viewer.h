// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include "knotreel/document/frame_model.h"
#include "knotreel/export/pdf.h"
#include "knotreel/export/svg.h"
#include "knotreel/image/image.h"
#include "knotreel/image/read_image.h"
#include "knotreel/raster/render.h"
#include "raster/feature_trace.h"
#include "raster/surface.h"
#include "support/process.h"
#include "support/temp_dir.h"

/// Exports as other programs draw them, next to our own rendering.
namespace knotreel::testing {

enum class Viewer { kPoppler, kMupdf, kLibrsvg };

inline std::string viewer_name(Viewer v) {
  return v == Viewer::kPoppler ? "poppler" : v == Viewer::kMupdf ? "mupdf" : "librsvg";
}

/// Exports a model and has a viewer draw it on white at `scale`.
inline image::Image drawn_by(Viewer viewer, const document::FrameModel& model, int scale,
                             const exporting::ExportOptions& options = {}) {
  const test::TempDir dir;
  const std::string svg = (dir / "x.svg").string();
  const std::string pdf = (dir / "x.pdf").string();
  const std::string png = (dir / "out.png").string();
  OutputFile file(viewer == Viewer::kLibrsvg ? svg : pdf);
  if (viewer == Viewer::kLibrsvg) {
    write_svg(model, options, file);
  } else {
    write_pdf(model, options, file);
  }
  file.commit();
  const std::string dpi = std::to_string(72 * scale);
  test::ProcessResult result;
  if (viewer == Viewer::kPoppler) {
    result = test::run({"/usr/bin/pdftoppm", "-r", dpi, "-png", "-singlefile", pdf, (dir / "out").string()});
  } else if (viewer == Viewer::kMupdf) {
    result = test::run({"/usr/bin/mutool", "draw", "-q", "-r", dpi, "-o", png, pdf});
  } else {
    result = test::run({"/usr/bin/rsvg-convert", "-z", std::to_string(scale), "-b", "white", "-o", png, svg});
  }
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return image::read_image(png);
}

/// Our own rendering on white, as RGB or grey.
inline image::Image drawn_by_us(const document::FrameModel& model, int scale) {
  raster::RenderOptions options;
  options.width = static_cast<int>(std::lround(model.space->mesh().width)) * scale;
  options.height = static_cast<int>(std::lround(model.space->mesh().height)) * scale;
  const std::vector<float> samples = raster::render(model, options);
  const bool alpha = model.channels % 2 == 0;
  const int colours = model.channels - (alpha ? 1 : 0);
  image::Image image = image::make_image(options.width, options.height, colours);
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      const float* s = &samples[static_cast<std::size_t>((y * options.width + x) * model.channels)];
      const float a = alpha ? std::clamp(s[colours], 0.0F, 255.0F) / 255 : 1.0F;
      for (int c = 0; c < colours; ++c) {
        image.at(x, y, c) = a * std::clamp(s[c], 0.0F, 255.0F) + 255 * (1 - a);
      }
    }
  }
  return image;
}

/// Differences of two pictures in levels, the largest of a pixel's channels.
struct Differences {
  double mean_off = 0;  ///< over the pixels off the features
  double max_off = 0;
  double mean_at = 0;  ///< over the pixels within `kNear` of a feature curve
  double max_at = 0;
};

inline constexpr double kNear = 1.5;  ///< output pixels from a centre to the curve

inline Differences compare(const document::FrameModel& model, int scale, const image::Image& theirs,
                           const image::Image& ours) {
  const raster::FeatureTrace trace(raster::Surface(model), model.space->mesh());
  Differences d;
  double off = 0;
  double at = 0;
  for (int y = 0; y < ours.height; ++y) {
    for (int x = 0; x < ours.width; ++x) {
      double difference = 0;
      for (int c = 0; c < ours.channels; ++c) {
        difference = std::max(difference, std::abs(double{theirs.at(x, y, std::min(c, theirs.channels - 1))} -
                                                   double{ours.at(x, y, c)}));
      }
      if (trace.distance({(x + 0.5) / scale, (y + 0.5) / scale}, 16) * scale > kNear) {
        off += 1;
        d.mean_off += difference;
        d.max_off = std::max(d.max_off, difference);
      } else {
        at += 1;
        d.mean_at += difference;
        d.max_at = std::max(d.max_at, difference);
      }
    }
  }
  d.mean_off /= std::max(off, 1.0);
  d.mean_at /= std::max(at, 1.0);
  return d;
}

}  // namespace knotreel::testing
