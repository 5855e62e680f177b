// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "knotreel/raster/render.h"
#include "knotreel/spline/reference.h"
#include "raster/colour_mean.h"
#include "raster/feature_trace.h"
#include "raster/frame_size.h"

/// The renderer that is meant to be obviously right: nothing shared with the fast one but the feature curves,
/// which only tell where to take many samples.
namespace knotreel::raster {

namespace {

class ReferenceSurface {
 public:
  explicit ReferenceSurface(const document::FrameModel& model) : model_(model), basis_(*model.space) {}

  struct Sample {
    Vec2 image;
    double jacobian[2][2];
    std::array<double, 4> colour{};
  };

  Sample at(Vec2 u) const {
    Sample s{};
    const auto colours = static_cast<std::size_t>(model_.channels);
    const std::vector<spline::Jet> jets = basis_.evaluate_all(u);
    for (spline::FunctionIndex f = 0; f < jets.size(); ++f) {
      const Vec2 c = model_.space->greville(f) + model_.displacement[model_.space->geometry_of()[f]];
      s.image = s.image + jets[f].value * c;
      s.jacobian[0][0] += jets[f].dx * c.x;
      s.jacobian[0][1] += jets[f].dy * c.x;
      s.jacobian[1][0] += jets[f].dx * c.y;
      s.jacobian[1][1] += jets[f].dy * c.y;
      for (std::size_t k = 0; k < colours; ++k) s.colour[k] += jets[f].value * model_.colour[f * colours + k];
    }
    return s;
  }

  /// Colour at an image point: Newton's method with halved steps, from a ring of starts.
  std::array<double, 4> colour_at(Vec2 x) const {
    double best = std::numeric_limits<double>::infinity();
    std::array<double, 4> colour{};
    for (int start = 0; start < 9 && best > 1e-8; ++start) {
      const double angle = start * 0.7853981633974483;
      Vec2 u = start == 0 ? clamped(x) : clamped(x + 1.5 * Vec2{std::cos(angle), std::sin(angle)});
      Sample s = at(u);
      double residual = norm(s.image - x);
      for (int step = 0; step < 50 && residual > 1e-10; ++step) {
        const auto& j = s.jacobian;
        const double det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        const Vec2 r = x - s.image;
        const Vec2 move =
            det > 0.05 ? Vec2{(j[1][1] * r.x - j[0][1] * r.y) / det, (j[0][0] * r.y - j[1][0] * r.x) / det}
                       : r;
        double t = 1;
        for (; t > 1e-4; t *= 0.5) {
          const Vec2 next = clamped(u + t * move);
          const Sample sample = at(next);
          if (norm(sample.image - x) >= residual) continue;
          u = next;
          s = sample;
          residual = norm(sample.image - x);
          break;
        }
        if (t <= 1e-4) break;
      }
      if (residual < best) {
        best = residual;
        colour = s.colour;
      }
    }
    return colour;
  }

 private:
  Vec2 clamped(Vec2 u) const {
    return {std::clamp(u.x, 0.0, model_.space->mesh().width),
            std::clamp(u.y, 0.0, model_.space->mesh().height)};
  }

  const document::FrameModel& model_;
  spline::ReferenceBasis basis_;
};

/// The mean of each pixel of the whole picture by itself, by many samples where a feature crosses it.
class ReferencePicture {
 public:
  ReferencePicture(const document::FrameModel& model, const FrameSize& size, bool antialias)
      : size_(size),
        surface_(model),
        trace_(Surface(model), model.space->mesh()),
        channels_(static_cast<std::size_t>(model.channels)),
        antialias_(antialias) {}

  bool is_crossed(int x, int y) const {
    return antialias_ &&
           !trace_.crossed_pixels(size_.pixel_width, size_.pixel_height, y, y + 1, x, x + 1).empty();
  }

  std::array<float, 4> pixel(int x, int y) const {
    constexpr int kFine = 16;
    const bool crossed = is_crossed(x, y);
    const int nx = crossed ? kFine : static_cast<int>(std::ceil(size_.pixel_width - 1e-9));
    const int ny = crossed ? kFine : static_cast<int>(std::ceil(size_.pixel_height - 1e-9));
    ColourMean mean(channels_);
    for (int sy = 0; sy < ny; ++sy) {
      for (int sx = 0; sx < nx; ++sx) {
        const auto colour = surface_.colour_at(
            {(x + (sx + 0.5) / nx) * size_.pixel_width, (y + (sy + 0.5) / ny) * size_.pixel_height});
        mean.add(colour.data(), 1);
      }
    }
    std::array<float, 4> result{};
    mean.store(result.data());
    return result;
  }

  /// The same through the filter for edges, next to features; for pictures no smaller than the model.
  std::array<float, 4> softened_pixel(int x, int y, double softness) const {
    bool near = false;
    for (int i = 0; i < 9; ++i)
      near = near || (is_inside(x, y, i) && is_crossed(x - 1 + i % 3, y - 1 + i / 3));
    if (!near || softness == 0) return pixel(x, y);
    ColourMean mean(channels_);
    for (int i = 0; i < 9; ++i) {
      const auto weight = [&](int place) { return place == 1 ? 1 - 2 * softness : softness; };
      const auto neighbour = pixel(std::clamp(x - 1 + i % 3, 0, size_.width - 1),
                                   std::clamp(y - 1 + i / 3, 0, size_.height - 1));
      mean.add(neighbour.data(), 1, weight(i % 3) * weight(i / 3));
    }
    std::array<float, 4> result{};
    mean.store(result.data());
    return result;
  }

 private:
  bool is_inside(int x, int y, int neighbour) const {
    const int u = x - 1 + neighbour % 3;
    const int v = y - 1 + neighbour / 3;
    return u >= 0 && u < size_.width && v >= 0 && v < size_.height;
  }

  FrameSize size_;
  ReferenceSurface surface_;
  FeatureTrace trace_;
  std::size_t channels_;
  bool antialias_;
};

}  // namespace

std::vector<float> render_reference(const document::FrameModel& model, const RenderOptions& options) {
  const FrameSize size = resolve_size(model, options);
  const ReferencePicture picture(model, size, options.antialias);
  std::vector<float> out;
  for (int y = size.crop_y; y < size.crop_y + size.crop_height; ++y) {
    for (int x = size.crop_x; x < size.crop_x + size.crop_width; ++x) {
      const auto pixel = picture.softened_pixel(x, y, options.antialias ? model.edge_softness : 0);
      out.insert(out.end(), pixel.begin(), pixel.begin() + model.channels);
    }
  }
  return out;
}

}  // namespace knotreel::raster
