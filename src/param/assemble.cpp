// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/assemble.h"

#include <cmath>

#include "knotreel/base/parallel.h"
#include "param/chord.h"

namespace knotreel::param {
namespace {

/// Displacements off the features up to kZero pixels become zero and those from kKept on stay as they are; in
/// between the length grows linearly from 0 to kKept. So the field stays continuous, and no neighbouring
/// displacements get further apart than twice their difference.
constexpr double kZero = 1.0 / 64;
constexpr double kKept = 1.0 / 32;

Vec2 damped(double x, double y) {
  const double length = std::sqrt(x * x + y * y);
  if (length >= kKept) return {x, y};
  if (length <= kZero) return {};
  const double scale = kKept * (length - kZero) / ((kKept - kZero) * length);
  return {scale * x, scale * y};
}

class PolylineAssembler {
 public:
  PolylineAssembler(Curves& curves, Parametrization& result)
      : curves_(curves), result_(result), vertex_of_(curves.sites.size(), kNone) {}

  void add(const Curve& curve) {
    Polyline line;
    line.chain = curve.chain;
    line.closed = curve.closed;
    const std::vector<Span> segments = segments_of(curves_, curve);
    for (const Span s : segments) line.vertices.push_back(vertex(site_of(curve, s.begin)));
    if (!curve.closed) line.vertices.push_back(vertex(curve.sites.back()));

    const auto number = static_cast<std::uint32_t>(result_.polylines.size());
    std::vector<CurveSample> samples(curve.sites.size());
    for (std::uint32_t i = 0; i < segments.size(); ++i) {
      measure(curves_, curve, segments[i], chord_);
      for (std::size_t k = 0; k < segments[i].end - segments[i].begin; ++k) {
        const std::size_t index = (segments[i].begin + k) % curve.sites.size();
        Site& site = curves_.sites[curve.sites[index]];
        const double along = k == 0 ? 0 : chord_.along[k];
        site.parameter = k == 0 ? site.position : chord_.a + along * chord_.direction;
        samples[index] = {number, i, along / chord_.length, site.position + site.beyond, site.pixel};
      }
    }
    if (!curve.closed) {
      Site& last = curves_.sites[curve.sites.back()];
      last.parameter = last.position;
      samples.back() = {number, static_cast<std::uint32_t>(segments.size() - 1), 1.0,
                        last.position + last.beyond, last.pixel};
    }
    result_.curve_samples.insert(result_.curve_samples.end(), samples.begin(), samples.end());
    result_.polylines.push_back(std::move(line));
  }

 private:
  std::uint32_t vertex(SiteIndex s) {
    if (vertex_of_[s] == kNone) {
      vertex_of_[s] = static_cast<std::uint32_t>(result_.vertices.size());
      result_.vertices.push_back({curves_.sites[s].position, curves_.sites[s].place});
    }
    return vertex_of_[s];
  }

  Curves& curves_;
  Parametrization& result_;
  std::vector<std::uint32_t> vertex_of_;
  Chord chord_;
};

}  // namespace

void assemble_polylines(Curves& curves, Parametrization& result) {
  result.vertices.clear();
  result.polylines.clear();
  result.curve_samples.clear();
  PolylineAssembler assembler(curves, result);
  for (const Curve& curve : curves.curves) {
    if (!curve.dropped) assembler.add(curve);
  }
}

void put_layouts_at_rest(const Curves& curves, Parametrization& result) {
  const auto width = static_cast<std::size_t>(curves.width);
  result.width = curves.width;
  result.height = curves.height;
  result.position.resize(width * static_cast<std::size_t>(curves.height));
  parallel_for(static_cast<std::size_t>(curves.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x)
      result.position[y * width + x] = {static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5};
  });
  result.parameter = result.position;
}

void assemble_layouts(const Curves& curves, const Framed<Quad>& field, const Tiles& tiles,
                      Parametrization& result) {
  const auto width = static_cast<std::size_t>(curves.width);
  parallel_for(static_cast<std::size_t>(curves.height), [&](std::size_t y) {
    const Quad* row = field.row(static_cast<int>(y));
    for (std::size_t x = 0; x < width; ++x) {
      if (!tiles.has_cell(static_cast<int>(x), static_cast<int>(y))) continue;
      const Vec2 centre{static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5};
      const std::size_t pixel = y * width + x;
      if (const SiteIndex s = curves.at_pixel[pixel]; s != kNone) {
        result.position[pixel] = curves.sites[s].position;
        result.parameter[pixel] = curves.sites[s].parameter;
        continue;
      }
      const Quad d = row[x];
      result.position[pixel] = centre + damped(d[0], d[1]);
      result.parameter[pixel] = centre + damped(d[2], d[3]);
    }
  });
}

}  // namespace knotreel::param
