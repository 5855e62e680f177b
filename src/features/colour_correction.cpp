// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/colour_correction.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/features/image_mesh.h"

namespace knotreel::features {
namespace {

enum class Place : std::uint8_t { kClean, kBeside, kFeature };

/// Pixels of the image mesh and their neighbours.
class Surroundings {
 public:
  explicit Surroundings(const FeatureChains& chains)
      : mesh_(make_image_mesh(chains)),
        places_(std::size_t(chains.width) * std::size_t(chains.height), Place::kClean) {
    for_points(chains, [&](int pixel) { places_[std::size_t(pixel)] = Place::kFeature; });
    for_points(chains, [&](int pixel) {
      for_neighbours(pixel, [&](int other) {
        if (place(other) != Place::kClean) return;
        places_[std::size_t(other)] = Place::kBeside;
        beside_.push_back(other);
      });
    });
  }

  Place place(int pixel) const { return places_[std::size_t(pixel)]; }
  /// All pixels beside features.
  const std::vector<int>& beside() const { return beside_; }

  /// The four neighbours, and those over the diagonals of the four squares.
  template <typename Body>
  void for_neighbours(int pixel, Body body) const {
    const int x = pixel % mesh_.width;
    const int y = pixel / mesh_.width;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= mesh_.width || y + dy >= mesh_.height) continue;
        if (dx == 0 && dy == 0) continue;
        if (dx != 0 && dy != 0) {
          const auto square = std::size_t(std::min(y, y + dy)) * std::size_t(mesh_.width - 1) +
                              std::size_t(std::min(x, x + dx));
          if (mesh_.diagonals[square] != (dx == dy ? 0 : 1)) continue;
        }
        body(pixel + dy * mesh_.width + dx);
      }
    }
  }

 private:
  template <typename Body>
  void for_points(const FeatureChains& chains, Body body) const {
    for (const Chain& chain : chains.chains) {
      for (const ChainPoint& p : chain.points) body(p.y * mesh_.width + p.x);
    }
  }

  ImageMesh mesh_;
  std::vector<Place> places_;
  std::vector<int> beside_;
};

/// Neighbours that are no feature pixels, first those one step away, then those two. Steps never cross
/// features, because all steps of features are edges of the mesh.
struct Rings {
  std::vector<int> one;
  std::vector<int> two;
};

void find_rings(const Surroundings& around, int pixel, Rings& rings) {
  rings.one.clear();
  rings.two.clear();
  const auto has = [](const std::vector<int>& list, int i) {
    return std::find(list.begin(), list.end(), i) != list.end();
  };
  around.for_neighbours(pixel, [&](int i) {
    if (around.place(i) != Place::kFeature) rings.one.push_back(i);
  });
  for (const int first : rings.one) {
    around.for_neighbours(first, [&](int i) {
      const bool is_new = i != pixel && !has(rings.one, i) && !has(rings.two, i);
      if (is_new && around.place(i) != Place::kFeature) rings.two.push_back(i);
    });
  }
}

double mean(const image::Image& image, const std::vector<int>& pixels, int c) {
  double sum = 0;
  for (const int i : pixels)
    sum += image.samples[std::size_t(i) * std::size_t(image.channels) + std::size_t(c)];
  return sum / double(pixels.size());
}

}  // namespace

image::Image correct_colours(const image::Image& image, const FeatureChains& chains,
                             const CorrectionOptions& options) {
  if (image.width != chains.width || image.height != chains.height) {
    throw Error(ErrorKind::kInvalidArgument, "the picture and its features differ in size");
  }
  const bool sound = options.one_ring >= 0 && options.two_ring >= 0 &&
                     std::abs(options.one_ring + options.two_ring - 1) <= 1e-9;
  if (!sound) {
    throw Error(ErrorKind::kInvalidArgument,
                "the weights of the colour correction must be positive with sum 1");
  }
  if (!(options.strength >= 0 && options.strength <= 1)) {
    throw Error(ErrorKind::kInvalidArgument, "the strength of the colour correction must be 0 to 1");
  }
  image::Image result = image;
  const Surroundings around(chains);
  const auto beside = [&](int i) { return around.place(i) != Place::kClean; };
  Rings rings;
  for (const int pixel : around.beside()) {
    find_rings(around, pixel, rings);
    if (std::all_of(rings.two.begin(), rings.two.end(), beside)) continue;
    if (options.clean_only) {
      std::erase_if(rings.one, beside);
      std::erase_if(rings.two, beside);
    }
    const double one_ring = rings.one.empty() ? 0 : options.one_ring;
    for (int c = 0; c < image.channels; ++c) {
      const auto sample = std::size_t(pixel) * std::size_t(image.channels) + std::size_t(c);
      double value = (1 - one_ring) * mean(image, rings.two, c);
      if (one_ring > 0) value += one_ring * mean(image, rings.one, c);
      const double own = double(image.samples[sample]);
      result.samples[sample] = float(own + options.strength * (value - own));
    }
  }
  return result;
}

}  // namespace knotreel::features
