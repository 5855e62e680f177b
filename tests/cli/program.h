#pragma once

#include <gtest/gtest.h>

#include <algorithm>
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
