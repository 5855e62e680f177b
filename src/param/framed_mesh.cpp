// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/framed_mesh.h"

namespace knotreel::param {
namespace {

enum Border : std::size_t { kLeftSide, kRightSide, kTopSide, kBottomSide };

}  // namespace

FramedMesh::FramedMesh(const features::ImageMesh& mesh, const Parametrization& parametrization)
    : mesh_(mesh) {
  const auto width = static_cast<std::size_t>(mesh.width);
  const auto height = static_cast<std::size_t>(mesh.height);
  for (const Border side : {kLeftSide, kRightSide, kTopSide, kBottomSide}) {
    along_[side].resize(side == kLeftSide || side == kRightSide ? height : width);
    for (std::size_t i = 0; i < along_[side].size(); ++i) along_[side][i] = static_cast<double>(i) + 0.5;
  }
  is_feature_.assign(width * height, 0);
  const std::vector<CurveSample>& samples = parametrization.curve_samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].pixel != kNoPixel) {
      is_feature_[static_cast<std::size_t>(samples[i].pixel)] = 1;
      continue;
    }
    // The pixel of an end on the border is that of the sample before it, or after it at the start of a chain.
    const bool at_end = i > 0 && samples[i - 1].polyline == samples[i].polyline;
    const std::int32_t pixel = samples[at_end ? i - 1 : i + 1].pixel;
    const Vec2 p = samples[i].position;
    const auto row = static_cast<std::size_t>(pixel / mesh.width);
    const auto column = static_cast<std::size_t>(pixel % mesh.width);
    if (p.x == 0 || p.x == mesh.width) {
      along_[p.x == 0 ? kLeftSide : kRightSide][row] = p.y;
    } else {
      along_[p.y == 0 ? kTopSide : kBottomSide][column] = p.x;
    }
  }
}

Vec2 FramedMesh::on_ring(int x, int y) const {
  const double w = mesh_.width;
  const double h = mesh_.height;
  const bool beyond_x = x < 0 || x >= mesh_.width;
  const bool beyond_y = y < 0 || y >= mesh_.height;
  if (beyond_x && beyond_y) return {x < 0 ? 0 : w, y < 0 ? 0 : h};
  if (beyond_x) return {x < 0 ? 0 : w, along_[x < 0 ? kLeftSide : kRightSide][static_cast<std::size_t>(y)]};
  return {along_[y < 0 ? kTopSide : kBottomSide][static_cast<std::size_t>(x)], y < 0 ? 0 : h};
}

std::array<FramedMesh::Triangle, 2> FramedMesh::triangles(int x, int y) const {
  const Corner a{x, y};
  const Corner b{x + 1, y};
  const Corner c{x + 1, y + 1};
  const Corner d{x, y + 1};
  const bool inside = x >= 0 && y >= 0 && x + 1 < mesh_.width && y + 1 < mesh_.height;
  const bool rising =
      inside && mesh_.diagonals[static_cast<std::size_t>(y) * (static_cast<std::size_t>(mesh_.width) - 1) +
                                static_cast<std::size_t>(x)] != 0;
  if (rising) return {{{a, b, d}, {b, c, d}}};
  return {{{a, b, c}, {a, c, d}}};
}

}  // namespace knotreel::param
