// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/debug/debug_pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <system_error>

#include "cli/debug/drawings.h"
#include "cli/debug/heat_map.h"
#include "cli/pictures.h"
#include "knotreel/base/error.h"
#include "knotreel/image/write_image.h"

namespace knotreel::cli::debug {

DebugPictures::DebugPictures(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (!error && !std::filesystem::is_directory(folder_)) {
    error = std::make_error_code(std::errc::not_a_directory);
  }
  if (error) {
    throw Error(ErrorKind::kOutput,
                fmt::format("cannot make the folder '{}': {}", folder_.string(), error.message()));
  }
}

void DebugPictures::write(const vectorize::Progress& p) {
  if (p.stage == "features") {
    draw_chains(*p.picture, *p.detected, nullptr).write(folder_ / "01-features.png");
  } else if (p.stage == "fairing") {
    draw_chains(*p.picture, *p.faired, p.detected).write(folder_ / "02-faired.png");
  } else if (p.stage == "correction") {
    enlarged(*p.corrected).write(folder_ / "03-corrected.png");
  } else if (p.stage == "parametrization") {
    draw_parametrization(*p.picture, *p.parametrization).write(folder_ / "04-parametrization.png");
  } else if (p.stage == "knots") {
    draw_mesh(*p.picture, *p.knot_mesh).write(folder_ / "05-knots.png");
  } else if (p.model != nullptr) {
    write_round(p);
  }
}

void DebugPictures::write_round(const vectorize::Progress& p) {
  std::string round = p.stage;
  std::replace(round.begin(), round.end(), ' ', '-');
  draw_mapped_mesh(*p.picture, *p.model).write(next(round + "-mesh"));
  const image::Image rendering = render_whole(*p.model, {});
  image::write_image(next(round + "-fit"), rendering);
  heat_map(*p.picture, rendering).write(next(round + "-error"));
}

void DebugPictures::write_control_net(const image::Image& picture, const document::FrameModel& model) {
  draw_control_net(picture, model).write(next("control-net"));
}

void DebugPictures::write_stored(const image::Image& picture, const document::FrameModel& model) {
  draw_mapped_mesh(picture, model).write(folder_ / "stored-mesh.png");
  const image::Image rendering = render_whole(model, {});
  image::write_image(folder_ / "stored-fit.png", rendering);
  heat_map(picture, rendering).write(folder_ / "stored-error.png");
  draw_control_net(picture, model).write(folder_ / "stored-control-net.png");
}

std::filesystem::path DebugPictures::next(const std::string& name) {
  return folder_ / fmt::format("{:02}-{}.png", number_++, name);
}

}  // namespace knotreel::cli::debug
