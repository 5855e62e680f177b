// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "knotreel/image/metrics.h"

namespace knotreel::cli {

/// A number, or null for what JSON has not: infinity and NaN.
nlohmann::ordered_json finite_or_null(double value);

/// Members mec, rmse, psnr, ssim; psnr is null for equal pictures, since JSON has no infinity.
nlohmann::ordered_json metrics_json(const image::ImageMetrics& metrics);

/// "31.25 dB", or "inf dB" for equal pictures.
std::string psnr_text(double psnr);

}  // namespace knotreel::cli
