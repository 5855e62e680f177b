// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/raster/edge_softness.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/raster/render.h"
#include "raster/feature_trace.h"
#include "raster/soften.h"
#include "raster/surface.h"

namespace knotreel::raster {
namespace {

/// Inner products of what a picture has beyond a drawing, d, with what the filter adds to that: its one part
/// goes with the softness s (l), the other with its square (q).
struct Products {
  double dl = 0;
  double dq = 0;
  double ll = 0;
  double lq = 0;
  double qq = 0;

  void add(double d, double l, double q) {
    dl += d * l;
    dq += d * q;
    ll += l * l;
    lq += l * q;
    qq += q * q;
  }

  /// |d - s l - s^2 q|^2, but for |d|^2.
  double error(double s) const {
    return -2 * s * dl + s * s * (ll - 2 * dq) + 2 * s * s * s * lq + s * s * s * s * qq;
  }
};

/// The parts that go with s and s^2, of one channel at one pixel.
std::pair<double, double> filter_parts(const image::Image& drawing, int x, int y, int channel) {
  const auto at = [&](int u, int v) {
    return static_cast<double>(
        drawing.at(std::clamp(u, 0, drawing.width - 1), std::clamp(v, 0, drawing.height - 1), channel));
  };
  const auto second = [&](int v) { return at(x - 1, v) - 2 * at(x, v) + at(x + 1, v); };
  const double along_x = second(y);
  const double along_y = at(x, y - 1) - 2 * at(x, y) + at(x, y + 1);
  return {along_x + along_y, second(y - 1) - 2 * along_x + second(y + 1)};
}

/// How much a pixel's colour counts: where it is transparent, it means nothing.
double opacity(const image::Image& picture, int x, int y, int channel) {
  if (!picture.has_alpha() || channel == picture.channels - 1) return 1;
  return static_cast<double>(picture.at(x, y, picture.channels - 1)) / 255;
}

}  // namespace

double fitting_edge_softness(document::FrameModel model, const image::Image& picture,
                             std::shared_ptr<const spline::Basis> basis,
                             std::shared_ptr<const spline::PixelSurface> known) {
  if (model.space->mesh().segments.empty()) return 0;
  model.edge_softness = 0;
  if (!basis) basis = std::make_shared<const spline::Basis>(model.space);
  image::Image drawing;
  std::vector<CrossedPixel> crossed;
  parallel_invoke([&] { drawing = Renderer(model, {}, basis, std::move(known)).whole(); },
                  [&] {
                    const FeatureTrace trace(Surface(model, basis), model.space->mesh());
                    crossed = trace.crossed_pixels(1, 1, 0, picture.height, 0, picture.width);
                  });
  if (drawing.width != picture.width || drawing.height != picture.height ||
      drawing.channels != picture.channels)
    throw Error(ErrorKind::kInvalidArgument, "a picture of another size tells nothing about a model");

  Products products;
  for (const Place& place : next_to(crossed, {0, picture.height, 0, picture.width})) {
    for (int c = 0; c < picture.channels; ++c) {
      const auto [l, q] = filter_parts(drawing, place.x, place.y, c);
      const double missed = static_cast<double>(picture.at(place.x, place.y, c)) -
                            static_cast<double>(drawing.at(place.x, place.y, c));
      const double weight = opacity(picture, place.x, place.y, c);
      products.add(weight * missed, weight * l, weight * q);
    }
  }
  const int most = static_cast<int>(document::kMostEdgeSoftness / document::kEdgeSoftnessStep);
  int best = 0;
  for (int s = 1; s <= most; ++s) {
    const auto error = [&](int steps) { return products.error(steps * document::kEdgeSoftnessStep); };
    if (error(s) < error(best)) best = s;
  }
  return best * document::kEdgeSoftnessStep;
}

}  // namespace knotreel::raster
