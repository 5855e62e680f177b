// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "knotreel/fit/geometry_fit.h"
#include "vectorize/half_rows.h"
#include "vectorize/mapped_picture.h"

namespace knotreel::vectorize {

/// Points of features, as the geometry is fitted to them, in the order of the map's curve samples.
std::vector<fit::CurvePoint> curve_points(const MappedPicture& mapped);

/// What surfaces are fitted to: the pixels of a picture and points of its features, with their places in the
/// domain.
class Samples {
 public:
  /// Places as the parametrization has them. @param picture, mapped outlive this; the corrected colours of
  /// pixels that features cross become those of their side.
  Samples(const image::Image& picture, MappedPicture& mapped, bool half_rows);
  Samples(const Samples&) = delete;
  Samples& operator=(const Samples&) = delete;

  fit::Pixels all() const { return {.image = &colours(), .weights = weights_, .places = places_}; }
  /// What rounds and descent are fitted to: all pixels, or pairs of rows, made of them before move().
  fit::Pixels steering() const { return half_ ? half_->view() : all(); }
  bool steers_by_half_rows() const { return half_.has_value(); }

  const image::Image& picture() const { return picture_; }
  /// Without the mixed colours beside features.
  const image::Image& colours() const { return mapped_.has_features() ? mapped_.corrected : picture_; }
  bool has_features() const { return mapped_.has_features(); }
  std::span<const float> weights() const { return weights_; }             ///< empty without features
  const std::vector<Vec2>& places() const { return places_; }             ///< empty without features
  const std::vector<fit::CurvePoint>& curves() const { return curves_; }  ///< on features
  /// Segments of the knot mesh, parallel to curves().
  std::span<const std::uint32_t> curve_segments() const { return curve_segments_; }

  /// Goes over to the places that a geometry gives to the pixels. @param crossed as weigh().
  void move(std::vector<Vec2> places, const std::vector<std::uint8_t>& crossed, const mesh::KnotMesh& mesh);
  /// Colours that pixels had before features that cross them gave them others.
  struct Replaced {
    std::vector<std::size_t> pixels;
    std::vector<float> samples;
  };
  /// What move() changes.
  struct State {
    image::Image corrected;
    std::vector<Vec2> places;
    std::vector<float> weights;
    Replaced replaced;
  };
  State state() const { return {mapped_.corrected, places_, weights_, replaced_}; }
  void restore(State state);
  /// Gives the places away.
  std::vector<Vec2> take_places() { return std::move(places_); }

 private:
  void place_pixels();
  std::vector<std::uint8_t> place_curves();
  void weigh(const std::vector<std::uint8_t>& crossed, const mesh::KnotMesh& mesh);
  void keep_colours(const std::vector<std::uint8_t>& crossed);
  void put_back_colours();

  const image::Image& picture_;
  MappedPicture& mapped_;
  std::vector<Vec2> places_;
  std::vector<float> weights_;
  Replaced replaced_;
  std::vector<fit::CurvePoint> curves_;
  std::vector<std::uint32_t> curve_segments_;
  std::optional<PixelData> half_;
};

}  // namespace knotreel::vectorize
