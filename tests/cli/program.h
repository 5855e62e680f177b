// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "knotreel/image/write_image.h"
#include "support/pictures.h"
#include "support/process.h"
#include "support/temp_dir.h"

namespace knotreel::test {

/// Runs `knotreel` with these arguments.
inline ProcessResult knotreel(std::vector<std::string> arguments, const ProcessOptions& options = {}) {
  arguments.insert(arguments.begin(), KNOTREEL_PROGRAM);
  return run(arguments, options);
}

/// The promise of every failure: the exit code, one line that begins with the program's name, nothing else.
inline void expect_failure(const ProcessResult& result, int exit_code) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_TRUE(result.err.starts_with("knotreel: ")) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_TRUE(result.err.ends_with('\n'));
  EXPECT_EQ(result.out, "");
}

inline void expect_success(const ProcessResult& result) {
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

/// A smooth picture that a spline represents well.
inline image::Image smooth_picture(int width, int height, int channels) {
  image::Image image = image::make_image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = double(x) / width;
      const double v = double(y) / height;
      for (int c = 0; c < channels; ++c)
        image.at(x, y, c) = float(40 + 170 * u * (c == 1 ? 1 - v : v) + 20 * c);
    }
  }
  return image;
}

/// A disc and a bar with sharp edges on a ramp: there are features.
inline image::Image sharp_picture(int width, int height, int channels) {
  image::Image image = smooth_picture(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double distance = std::hypot(x + 0.5 - 0.35 * width, y + 0.5 - 0.5 * height);
      const double inside = std::clamp(0.3 * height - distance + 0.5, 0.0, 1.0);
      const bool bar = x > 0.75 * width && x < 0.9 * width && y > 0.2 * height && y < 0.8 * height;
      for (int c = 0; c < channels; ++c) {
        float& sample = image.at(x, y, c);
        sample = bar ? 20.0F : float((1 - inside) * double(sample) + inside * (c == 2 ? 60 : 245));
      }
    }
  }
  return image;
}

/// PSNR from the JSON of `compare` or of --stats, where null stands for equal pictures.
inline double json_psnr(const nlohmann::json& figures) {
  return figures["psnr"].is_null() ? INFINITY : figures["psnr"].get<double>();
}

/// A folder with a picture and its document, made once by each test that asks for it.
struct Sample {
  TempDir dir;
  std::string picture = (dir / "in.png").string();
  std::string document = (dir / "in.tcb").string();

  explicit Sample(int channels = 3, int width = 64, int height = 40) {
    image::write_image(picture, smooth_picture(width, height, channels));
    expect_success(knotreel({"vectorize", picture, "-o", document}));
  }
  std::string path(const std::string& name) const { return (dir / name).string(); }
};

}  // namespace knotreel::test
