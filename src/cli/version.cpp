// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/version.h>
#include <fmt/core.h>
#include <oneapi/tbb/version.h>
#include <png.h>
#include <tiffio.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <opencv2/core/version.hpp>

#include "cli/command.h"

namespace knotreel::cli {

std::string version_text() {
  return fmt::format(
      "knotreel {} (OpenCV {}, CGAL {}, Eigen {}.{}.{}, oneTBB {}, libpng {}, libtiff {}.{}.{}, CLI11 {})\n"
      "Copyright (C) 2026 the knotreel authors. Licence: GNU GPL version 3 or later.\n"
      "There is no warranty, to the extent permitted by law.\n",
      KNOTREEL_VERSION, CV_VERSION, CGAL_VERSION_STR, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION,
      EIGEN_MINOR_VERSION, TBB_runtime_version(), png_get_libpng_ver(nullptr), TIFFLIB_MAJOR_VERSION,
      TIFFLIB_MINOR_VERSION, TIFFLIB_MICRO_VERSION, CLI11_VERSION);
}

}  // namespace knotreel::cli
