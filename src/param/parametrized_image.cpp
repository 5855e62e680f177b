// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/param/parametrized_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "param/crossed_pixels.h"
#include "param/framed_mesh.h"

namespace knotreel::param {
namespace {

constexpr int kRowsOfBand = 16;
/// Barycentric coordinates down to this count as inside: a pixel centre on an edge must not fall between two
/// triangles. Both give the same colour there, unless the edge is of a feature, and then the pixel has no
/// weight.
constexpr double kOnEdge = -1e-9;

enum class Source : std::uint8_t {
  kCopied,     ///< from the picture
  kDrawn,      ///< by a triangle
  kColourless  ///< in a triangle of three feature pixels
};

class Resampler {
 public:
  Resampler(const image::Image& picture, const features::ImageMesh& mesh,
            const Parametrization& parametrization)
      : picture_(picture),
        parametrization_(parametrization),
        mesh_(mesh, parametrization),
        active_(parametrization.parameter.size()),
        source_(parametrization.parameter.size(), Source::kCopied),
        out_{picture, std::vector<float>(parametrization.parameter.size(), 1.0F)} {}

  ParametrizedImage run() {
    find_active();
    const int bands = (picture_.height + kRowsOfBand - 1) / kRowsOfBand;
    parallel_for(static_cast<std::size_t>(bands), [&](std::size_t band) {
      const int first = static_cast<int>(band) * kRowsOfBand;
      draw_rows(first, std::min(first + kRowsOfBand, picture_.height));
    });
    fill_colourless();
    clear_crossed_pixels(parametrization_, out_.weights);
    return std::move(out_);
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_.width) +
           static_cast<std::size_t>(x);
  }

  /// Active are feature pixels and those with a displacement; triangles without any need not be drawn.
  void find_active() {
    std::vector<double> reach(static_cast<std::size_t>(picture_.height));
    parallel_for(reach.size(), [&](std::size_t y) {
      for (int x = 0; x < picture_.width; ++x) {
        const std::size_t i = index(x, static_cast<int>(y));
        const Vec2 d = parametrization_.parameter[i] - Vec2{x + 0.5, static_cast<double>(y) + 0.5};
        active_[i] = d != Vec2{} || mesh_.is_feature(i);
        reach[y] = std::max(reach[y], std::abs(d.y));
      }
    });
    reach_ = static_cast<int>(std::ceil(*std::max_element(reach.begin(), reach.end()))) + 1;
  }

  void draw_rows(int first, int end) {
    for (int y = std::max(-1, first - reach_ - 1); y < std::min(end + reach_, picture_.height); ++y) {
      for (int x = -1; x < picture_.width; ++x) {
        if (!active_[mesh_.pixel(x, y)] && !active_[mesh_.pixel(x + 1, y)] &&
            !active_[mesh_.pixel(x, y + 1)] && !active_[mesh_.pixel(x + 1, y + 1)]) {
          continue;
        }
        for (const FramedMesh::Triangle& t : mesh_.triangles(x, y)) draw(t, first, end);
      }
    }
  }

  void draw(const FramedMesh::Triangle& t, int first_row, int end_row) {
    std::array<Vec2, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh_.vertex(parametrization_.parameter, t[k].x, t[k].y);
    const double area = signed_area(p[0], p[1], p[2]);
    if (area <= 0) return;
    const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
    const int x0 = std::max(0, static_cast<int>(std::ceil(left - 0.5 + kOnEdge)));
    const int x1 = std::min(picture_.width - 1, static_cast<int>(std::floor(right - 0.5 - kOnEdge)));
    const int y0 = std::max(first_row, static_cast<int>(std::ceil(top - 0.5 + kOnEdge)));
    const int y1 = std::min(end_row - 1, static_cast<int>(std::floor(bottom - 0.5 - kOnEdge)));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const Vec2 g{x + 0.5, y + 0.5};
        const double b = signed_area(p[2], p[0], g) / area;
        const double c = signed_area(p[0], p[1], g) / area;
        if (b >= kOnEdge && c >= kOnEdge && b + c <= 1 - kOnEdge) colour(t, {1 - b - c, b, c}, x, y);
      }
    }
  }

  /// Interpolates from the vertices off the features. Written as steps from the first of them, so that equal
  /// colours give just that colour.
  void colour(const FramedMesh::Triangle& t, const std::array<double, 3>& share, int x, int y) {
    std::array<std::size_t, 3> pixel{};
    std::array<double, 3> weight{};
    std::size_t count = 0;
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t from = mesh_.pixel(t[k].x, t[k].y);
      if (mesh_.is_feature(from)) continue;
      pixel[count] = from;
      weight[count] = std::max(0.0, share[k]);
      sum += weight[count++];
    }
    const std::size_t target = index(x, y);
    if (count == 0) {
      if (source_[target] == Source::kCopied) source_[target] = Source::kColourless;
      return;
    }
    source_[target] = Source::kDrawn;
    const auto channels = static_cast<std::size_t>(picture_.channels);
    for (std::size_t ch = 0; ch < channels; ++ch) {
      const double base = picture_.samples[pixel[0] * channels + ch];
      double value = base;
      for (std::size_t k = 1; k < count; ++k) {
        const double w = sum > -kOnEdge ? weight[k] / sum : 1.0 / static_cast<double>(count);
        value += w * (picture_.samples[pixel[k] * channels + ch] - base);
      }
      out_.colours.samples[target * channels + ch] = static_cast<float>(value);
    }
  }

  /// Pixels without a colour get the mean of their neighbours that have one, from the outside inwards.
  void fill_colourless() {
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < source_.size(); ++i) {
      if (source_[i] != Source::kColourless) continue;
      open.push_back(i);
      out_.weights[i] = 0;
    }
    while (!open.empty()) {
      std::vector<std::size_t> left;
      std::vector<std::size_t> filled;
      for (const std::size_t i : open) (fill_from_neighbours(i) ? filled : left).push_back(i);
      if (filled.empty()) break;  // nothing but features: what was copied stays
      for (const std::size_t i : filled) source_[i] = Source::kDrawn;
      open = std::move(left);
    }
  }

  bool fill_from_neighbours(std::size_t i) {
    const auto width = static_cast<std::size_t>(picture_.width);
    const int x = static_cast<int>(i % width);
    const int y = static_cast<int>(i / width);
    const auto channels = static_cast<std::size_t>(picture_.channels);
    std::vector<std::size_t> near;
    for (int ny = std::max(0, y - 1); ny <= std::min(picture_.height - 1, y + 1); ++ny) {
      for (int nx = std::max(0, x - 1); nx <= std::min(picture_.width - 1, x + 1); ++nx) {
        if (source_[index(nx, ny)] != Source::kColourless) near.push_back(index(nx, ny));
      }
    }
    if (near.empty()) return false;
    for (std::size_t ch = 0; ch < channels; ++ch) {
      const float base = out_.colours.samples[near[0] * channels + ch];
      float sum = 0;
      for (const std::size_t n : near) sum += out_.colours.samples[n * channels + ch] - base;
      out_.colours.samples[i * channels + ch] = base + sum / static_cast<float>(near.size());
    }
    return true;
  }

  const image::Image& picture_;
  const Parametrization& parametrization_;
  FramedMesh mesh_;
  std::vector<std::uint8_t> active_;
  std::vector<Source> source_;
  ParametrizedImage out_;
  int reach_ = 0;
};

}  // namespace

ParametrizedImage parametrized_image(const image::Image& corrected, const features::FeatureChains& chains,
                                     const features::ImageMesh& mesh,
                                     const Parametrization& parametrization) {
  const auto same = [&](int width, int height) {
    return width == corrected.width && height == corrected.height;
  };
  if (!same(chains.width, chains.height) || !same(mesh.width, mesh.height) ||
      !same(parametrization.width, parametrization.height) ||
      parametrization.parameter.size() != corrected.pixel_count()) {
    throw Error(ErrorKind::kInvalidArgument,
                "picture, chains, mesh and parametrization are of different sizes");
  }
  return Resampler(corrected, mesh, parametrization).run();
}

}  // namespace knotreel::param
