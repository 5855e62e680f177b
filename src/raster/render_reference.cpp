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

}  // namespace

std::vector<float> render_reference(const document::FrameModel& model, const RenderOptions& options) {
  const FrameSize size = resolve_size(model, options);
  const ReferenceSurface surface(model);
  const FeatureTrace trace(Surface(model), model.space->mesh());
  const auto channels = static_cast<std::size_t>(model.channels);
  const int reduce_x = static_cast<int>(std::ceil(size.pixel_width - 1e-9));
  const int reduce_y = static_cast<int>(std::ceil(size.pixel_height - 1e-9));
  constexpr int kFine = 16;
  std::vector<float> out;
  for (int y = size.crop_y; y < size.crop_y + size.crop_height; ++y) {
    for (int x = size.crop_x; x < size.crop_x + size.crop_width; ++x) {
      const bool crossed =
          options.antialias &&
          !trace.crossed_pixels(size.pixel_width, size.pixel_height, y, y + 1, x, x + 1).empty();
      const int nx = crossed ? kFine : reduce_x;
      const int ny = crossed ? kFine : reduce_y;
      ColourMean mean(channels);
      for (int sy = 0; sy < ny; ++sy) {
        for (int sx = 0; sx < nx; ++sx) {
          const auto colour = surface.colour_at(
              {(x + (sx + 0.5) / nx) * size.pixel_width, (y + (sy + 0.5) / ny) * size.pixel_height});
          mean.add(colour.data(), 1);
        }
      }
      out.resize(out.size() + channels);
      mean.store(out.data() + out.size() - channels);
    }
  }
  return out;
}

}  // namespace knotreel::raster
