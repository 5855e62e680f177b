// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/edge_colours.h"

#include <algorithm>
#include <array>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

struct Line {
  Vec2 a, b;
};

/// Feature segments by square cells of the domain.
class SegmentIndex {
 public:
  explicit SegmentIndex(const mesh::KnotMesh& mesh)
      : columns_(static_cast<std::size_t>(mesh.width / kCell) + 1),
        cells_(columns_ * (static_cast<std::size_t>(mesh.height / kCell) + 1)) {
    for (const mesh::FeatureSegment& s : mesh.segments) {
      const Line line{mesh.knots[s.knots.front()].position, mesh.knots[s.knots.back()].position};
      for_cells(line, [&](std::size_t cell) { cells_[cell].push_back(line); });
    }
  }

  /// Whether the way from p to q, a few pixels at most, crosses a feature.
  bool separated(Vec2 p, Vec2 q) const {
    bool crossing = false;
    for_cells({p, q}, [&](std::size_t cell) {
      for (const Line& l : cells_[cell]) {
        const bool across = (signed_area(l.a, l.b, p) > 0) != (signed_area(l.a, l.b, q) > 0);
        crossing = crossing || (across && (signed_area(p, q, l.a) > 0) != (signed_area(p, q, l.b) > 0));
      }
    });
    return crossing;
  }

 private:
  static constexpr double kCell = 16;

  template <class Visit>
  void for_cells(const Line& line, Visit&& visit) const {
    const auto cell = [](double v) { return static_cast<std::size_t>(std::max(0.0, v / kCell)); };
    const std::size_t rows = cells_.size() / columns_;
    const std::size_t bottom = std::min(rows - 1, cell(std::max(line.a.y, line.b.y)));
    const std::size_t right = std::min(columns_ - 1, cell(std::max(line.a.x, line.b.x)));
    for (std::size_t y = std::min(bottom, cell(std::min(line.a.y, line.b.y))); y <= bottom; ++y) {
      for (std::size_t x = std::min(right, cell(std::min(line.a.x, line.b.x))); x <= right; ++x) {
        visit(y * columns_ + x);
      }
    }
  }

  std::size_t columns_;
  std::vector<std::vector<Line>> cells_;
};

}  // namespace

std::vector<std::uint8_t> clear_edge_colours(image::Image& picture, std::span<const Vec2> places,
                                             std::span<const std::uint8_t> crossed,
                                             const mesh::KnotMesh& mesh) {
  const SegmentIndex segments(mesh);
  const auto width = static_cast<std::size_t>(picture.width);
  const auto channels = static_cast<std::size_t>(picture.channels);
  std::vector<std::uint8_t> given(crossed.size(), 0);
  const auto clear = [&](std::size_t i) {
    const int x = static_cast<int>(i % width);
    const int y = static_cast<int>(i / width);
    std::array<double, 4> sum{};
    int count = 0;
    for (int v = std::max(0, y - 1); v <= std::min(picture.height - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(picture.width - 1, x + 1); ++u) {
        const std::size_t j = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
        if (crossed[j] || segments.separated(places[i], places[j])) continue;
        for (std::size_t c = 0; c < channels; ++c)
          sum[c] += static_cast<double>(picture.samples[j * channels + c]);
        ++count;
      }
    }
    if (count == 0) return;
    given[i] = 1;
    for (std::size_t c = 0; c < channels; ++c)
      picture.samples[i * channels + c] = static_cast<float>(sum[c] / count);
  };
  // What is read is not crossed, what is written is: rows do not depend on each other.
  parallel_for(crossed.size() / width, [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      if (crossed[i]) clear(i);
    }
  });
  return given;
}

std::vector<float> edge_weights(std::span<const std::uint8_t> crossed, std::span<const std::uint8_t> given) {
  std::vector<float> weights(crossed.size());
  for (std::size_t i = 0; i < crossed.size(); ++i)
    weights[i] = !crossed[i] ? 1.0F : given[i] ? kEdgeWeight : 0.0F;
  return weights;
}

}  // namespace knotreel::fit
