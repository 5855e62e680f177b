// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/samples.h"

#include <algorithm>
#include <utility>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/edge_colours.h"
#include "vectorize/smooth_vertices.h"

namespace knotreel::vectorize {

namespace {

constexpr int kLeastRows = 16;  // of a picture whose rows are paired

Vec2 parameter_of(const param::Parametrization& map, const param::CurveSample& s) {
  const param::Polyline& line = map.polylines[s.polyline];
  const Vec2 a = map.vertices[line.vertices[s.segment]].position;
  const Vec2 b = map.vertices[line.vertices[(s.segment + 1) % line.vertices.size()]].position;
  return a + s.t * (b - a);
}

/// The first segment of each polyline: initial_mesh() makes them in the order of the polylines.
std::vector<std::uint32_t> first_segments(const std::vector<param::Polyline>& lines) {
  std::vector<std::uint32_t> first;
  std::uint32_t segments = 0;
  for (const param::Polyline& line : lines) {
    first.push_back(segments);
    segments += static_cast<std::uint32_t>(line.vertices.size() - (line.closed ? 0 : 1));
  }
  return first;
}

}  // namespace

std::vector<fit::CurvePoint> curve_points(const MappedPicture& mapped) {
  const param::Parametrization& map = mapped.parametrization;
  const std::vector<std::uint8_t> smooth = smooth_vertices(map, mapped.faired);
  std::vector<fit::CurvePoint> points;
  points.reserve(map.curve_samples.size());
  for (const param::CurveSample& s : map.curve_samples)
    points.push_back({parameter_of(map, s), s.position, smooth[points.size()] != 0});
  return points;
}

Samples::Samples(const image::Image& picture, MappedPicture& mapped, bool half_rows)
    : picture_(picture), mapped_(mapped) {
  if (mapped.has_features()) {
    place_pixels();
    weigh(place_curves(), mapped.knots);
  }
  if (half_rows && picture.height % 2 == 0 && picture.height >= kLeastRows)
    half_ = vectorize::half_rows(all());
}

/// Pixel centres in the domain.
void Samples::place_pixels() {
  const auto width = static_cast<std::size_t>(picture_.width);
  const param::Parametrization& map = mapped_.parametrization;
  places_.resize(picture_.pixel_count());
  parallel_for(places_.size() / width, [&](std::size_t row) {
    for (std::size_t column = 0; column < width; ++column) {
      const std::size_t i = row * width + column;
      const Vec2 centre{static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5};
      const Vec2 u = centre + (map.parameter[i] - map.position[i]);
      places_[i] = {std::clamp(u.x, 0.0, double(picture_.width)),
                    std::clamp(u.y, 0.0, double(picture_.height))};
    }
  });
}

/// @return 1 for pixels that features cross.
std::vector<std::uint8_t> Samples::place_curves() {
  const std::vector<std::uint32_t> segments = first_segments(mapped_.parametrization.polylines);
  std::vector<std::uint8_t> crossed(picture_.pixel_count(), 0);
  curves_ = curve_points(mapped_);
  for (const param::CurveSample& s : mapped_.parametrization.curve_samples) {
    curve_segments_.push_back(segments[s.polyline] + s.segment);
    const int x = std::clamp(static_cast<int>(s.position.x), 0, picture_.width - 1);
    const int y = std::clamp(static_cast<int>(s.position.y), 0, picture_.height - 1);
    crossed[std::size_t(y) * std::size_t(picture_.width) + std::size_t(x)] = 1;
  }
  return crossed;
}

void Samples::keep_colours(const std::vector<std::uint8_t>& crossed) {
  const std::vector<float>& colours = mapped_.corrected.samples;
  const auto channels = static_cast<std::size_t>(mapped_.corrected.channels);
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    if (!crossed[i]) continue;
    replaced_.pixels.push_back(i);
    const float* const colour = colours.data() + i * channels;
    replaced_.samples.insert(replaced_.samples.end(), colour, colour + channels);
  }
}

void Samples::put_back_colours() {
  const auto channels = static_cast<std::size_t>(mapped_.corrected.channels);
  const float* colour = replaced_.samples.data();
  for (const std::size_t i : replaced_.pixels) {
    std::copy_n(colour, channels, mapped_.corrected.samples.data() + i * channels);
    colour += channels;
  }
  replaced_ = {};
}

/// Pixels that features cross count little, with the colour of their side. Those that were crossed before,
/// and are not now, have their own again.
void Samples::weigh(const std::vector<std::uint8_t>& crossed, const mesh::KnotMesh& mesh) {
  put_back_colours();
  keep_colours(crossed);
  weights_ = fit::edge_weights(crossed, fit::clear_edge_colours(mapped_.corrected, places_, crossed, mesh));
}

void Samples::move(std::vector<Vec2> places, const std::vector<std::uint8_t>& crossed,
                   const mesh::KnotMesh& mesh) {
  places_ = std::move(places);
  weigh(crossed, mesh);
}

void Samples::restore(State state) {
  mapped_.corrected = std::move(state.corrected);
  places_ = std::move(state.places);
  weights_ = std::move(state.weights);
  replaced_ = std::move(state.replaced);
}

}  // namespace knotreel::vectorize
