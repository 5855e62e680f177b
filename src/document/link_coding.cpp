// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/link_coding.h"

#include <algorithm>

#include "document/arithmetic.h"
#include "document/identity.h"

namespace knotreel::document {
namespace {

using mesh::CornerIndex;

/// Triangles of the links of the frame before, in corners of this one.
class LinksBefore {
 public:
  /// None: nothing is expected.
  LinksBefore() = default;
  LinksBefore(const mesh::KnotMesh& mesh, const mesh::CutMesh& cut, const FrameState& before)
      : space_(before.space.get()) {
    before_of_ = match_corners(mesh, cut, before.mesh(), space_->cut());
    now_of_.assign(space_->cut().corners.size(), spline::kNoCorner);
    for (CornerIndex c = 0; c < before_of_.size(); ++c) {
      if (before_of_[c] != kNoMatch) now_of_[before_of_[c]] = c;
    }
  }

  /// Looks at the link of a multiset of corners.
  void look_at(std::span<const CornerIndex> vertex) {
    configs_ = {};
    // Configs hold the links of multisets of degree - 1 corners.
    if (!space_ || vertex.size() + 1 != static_cast<std::size_t>(space_->degree())) return;
    std::array<CornerIndex, 2> inner{spline::kNoCorner, spline::kNoCorner};
    for (std::size_t i = 0; i < vertex.size(); ++i) {
      if (before_of_[vertex[i]] == kNoMatch) return;
      inner[i] = before_of_[vertex[i]];
    }
    if (vertex.size() == 2 && inner[0] > inner[1]) std::swap(inner[0], inner[1]);
    // Not equal_range: the library's subranges are too much for clang 14, which the fuzzers need.
    const auto configs = space_->configs();
    const auto first = std::ranges::lower_bound(configs, inner, {}, &spline::Config::inner);
    const auto last = std::ranges::upper_bound(configs, inner, {}, &spline::Config::inner);
    configs_ = configs.subspan(static_cast<std::size_t>(first - configs.begin()),
                               static_cast<std::size_t>(last - first));
  }

  /// Third corner of the triangle at an edge, or kNoCorner.
  CornerIndex apex(CornerIndex from, CornerIndex to) const {
    const CornerIndex a = configs_.empty() ? kNoMatch : before_of_[from];
    const CornerIndex b = configs_.empty() ? kNoMatch : before_of_[to];
    if (a == kNoMatch || b == kNoMatch) return spline::kNoCorner;
    for (const spline::Config& c : configs_) {
      for (std::size_t i = 0; i < 3; ++i) {
        if (c.triangle[i] == a && c.triangle[(i + 1) % 3] == b) return now_of_[c.triangle[(i + 2) % 3]];
      }
    }
    return spline::kNoCorner;
  }

 private:
  const spline::SplineSpace* space_ = nullptr;
  std::vector<std::uint32_t> before_of_;  ///< corners
  std::vector<CornerIndex> now_of_;
  std::span<const spline::Config> configs_;
};

template <class Coder>
class LinkCoding {
 public:
  LinkCoding(Coder& coder, LinkModels& models, LinksBefore before)
      : coder_(coder), models_(models), before_(std::move(before)) {}

  /// @param given  for a writer, the codes of the polygon. @param codes  they are appended.
  void code(const spline::LinkPolygon& polygon, std::span<const std::uint16_t> given,
            std::vector<std::uint16_t>& codes) {
    before_.look_at(polygon.vertex);
    const auto ring = polygon.corners;
    open_.assign({{0, ring.size() - 1}});
    std::size_t count = 0;
    while (!open_.empty()) {
      const auto [i, j] = open_.back();
      open_.pop_back();
      if (j - i <= 2) continue;
      const std::size_t code = apex(ring, i, j, Coder::kWriting ? given[count++] : 0);
      codes.push_back(static_cast<std::uint16_t>(code));
      open_.emplace_back(i + 1 + code, j);
      open_.emplace_back(i, i + 1 + code);
    }
  }

 private:
  std::size_t apex(std::span<const CornerIndex> ring, std::size_t i, std::size_t j, std::size_t given) {
    const std::size_t span = std::min(j - i - 3, LinkModels::kSpans - 1);
    const CornerIndex expected = before_.apex(ring[j], ring[i]);
    const auto inside = ring.subspan(i + 1, j - i - 1);
    const auto place = static_cast<std::size_t>(std::ranges::find(inside, expected) - inside.begin());
    const bool expects = expected != spline::kNoCorner && place < inside.size();
    if (expects) {
      expected_last_ = coder_.bit(models_.expected[span][expected_last_ ? 1 : 0], given == place);
      if (expected_last_) return place;
    }
    const std::uint64_t code = code_number(coder_, models_.code[span][expects ? 1 : 0], given);
    if (code >= inside.size() || code > 0xffff) malformed("a link code is out of range");
    return static_cast<std::size_t>(code);
  }

  Coder& coder_;
  LinkModels& models_;
  LinksBefore before_;
  bool expected_last_ = true;
  std::vector<std::pair<std::size_t, std::size_t>> open_;
};

}  // namespace

void write_links(const spline::SplineSpace& space, const FrameState* before, LinkModels& models,
                 ArithmeticWriter& out) {
  if (space.degree() == 1) return;
  LinkCoding coding(out, models, before ? LinksBefore(space.mesh(), space.cut(), *before) : LinksBefore());
  std::vector<std::uint16_t> coded;
  spline::for_each_link(space,
                        [&](const spline::LinkPolygon& polygon, std::span<const std::uint16_t> codes, auto) {
                          coded.clear();
                          coding.code(polygon, codes, coded);
                        });
}

std::shared_ptr<const spline::SplineSpace> read_space(mesh::KnotMesh mesh, int degree,
                                                      const FrameState* before, LinkModels& models,
                                                      ArithmeticReader& in) {
  LinkCoding coding(in, models, before ? LinksBefore(mesh, mesh::cut_open(mesh), *before) : LinksBefore());
  return std::make_shared<spline::SplineSpace>(
      std::move(mesh), degree,
      [&](const spline::LinkPolygon& polygon, auto& codes) { coding.code(polygon, {}, codes); });
}

}  // namespace knotreel::document
