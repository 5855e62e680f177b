// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/metrics_report.h"

#include <fmt/core.h>

#include <cmath>

namespace knotreel::cli {

nlohmann::ordered_json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json metrics_json(const image::ImageMetrics& metrics) {
  nlohmann::ordered_json json;
  json["mec"] = metrics.mec;
  json["rmse"] = metrics.rmse;
  json["psnr"] = finite_or_null(metrics.psnr);
  json["ssim"] = metrics.ssim;
  return json;
}

std::string psnr_text(double psnr) {
  return fmt::format("{:.2f} dB", psnr);
}

}  // namespace knotreel::cli
