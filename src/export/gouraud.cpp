// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/gouraud.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "export/number_text.h"

namespace knotreel::exporting {

namespace {

constexpr double kCoordinateMax = (1 << 24) - 1;

using Triangle = std::array<std::uint32_t, 3>;

/// Hands out the triangles of a patch so that many share an edge with the one before.
class StripOrder {
 public:
  explicit StripOrder(const Patch& patch) : patch_(patch), used_(patch.triangles.size(), false) {
    for (std::uint32_t t = 0; t < used_.size(); ++t) {
      const Triangle& v = patch.triangles[t];
      for (std::size_t i = 0; i < 3; ++i) sides_.emplace(key(v[i], v[(i + 1) % 3]), t);
    }
  }

  /// The next triangle that is not used, turned so that a strip can go on over its last edge.
  std::optional<Triangle> start() {
    while (next_ < used_.size() && used_[next_]) ++next_;
    if (next_ == used_.size()) return std::nullopt;
    used_[next_] = true;
    Triangle v = patch_.triangles[next_];
    for (int turn = 0; turn < 2 && !neighbour(v[1], v[2]); ++turn)
      std::rotate(v.begin(), v.begin() + 1, v.end());
    return v;
  }

  /// The third vertex of an unused triangle with the edge a-b, which is used from now on.
  std::optional<std::uint32_t> go_on(std::uint32_t a, std::uint32_t b) {
    const auto t = neighbour(a, b);
    if (!t) return std::nullopt;
    used_[*t] = true;
    for (const std::uint32_t v : patch_.triangles[*t]) {
      if (v != a && v != b) return v;
    }
    return std::nullopt;
  }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
  }

  std::optional<std::uint32_t> neighbour(std::uint32_t a, std::uint32_t b) const {
    const auto [begin, end] = sides_.equal_range(key(a, b));
    for (auto it = begin; it != end; ++it) {
      if (!used_[it->second]) return it->second;
    }
    return std::nullopt;
  }

  const Patch& patch_;
  std::vector<bool> used_;
  std::multimap<std::uint64_t, std::uint32_t> sides_;
  std::size_t next_ = 0;
};

}  // namespace

std::string GouraudEncoder::entries() const {
  std::string text = "/ShadingType 4/ColorSpace/";
  text += count_ == 3 ? "DeviceRGB" : "DeviceGray";
  text += "/BitsPerFlag 8/BitsPerCoordinate 24/BitsPerComponent 8/Decode[";
  for (const double v : {box_.low.x, box_.high.x, box_.low.y, box_.high.y}) {
    append_number(text, v, 6);
    text += ' ';
  }
  for (std::size_t c = 0; c < count_; ++c) text += "0 1 ";
  text.back() = ']';
  return text;
}

void GouraudEncoder::put(int flag, const SurfacePoint& point, std::vector<std::byte>& out) const {
  out.push_back(static_cast<std::byte>(flag));
  const auto put_coordinate = [&](double v, double low, double high) {
    const double share = std::clamp((v - low) / (high - low), 0.0, 1.0);
    const auto n = static_cast<std::uint32_t>(std::lround(share * kCoordinateMax));
    for (const int shift : {16, 8, 0}) out.push_back(static_cast<std::byte>((n >> shift) & 255));
  };
  put_coordinate(point.x.x, box_.low.x, box_.high.x);
  put_coordinate(point.x.y, box_.low.y, box_.high.y);
  for (std::size_t c = first_; c < first_ + count_; ++c) {
    out.push_back(static_cast<std::byte>(std::lround(point.colour[c])));
  }
}

void GouraudEncoder::encode(const Patch& patch, std::vector<std::byte>& out) const {
  StripOrder strips(patch);
  while (const auto first = strips.start()) {
    auto [a, b, c] = *first;
    for (const std::uint32_t v : {a, b, c}) put(0, patch.vertices[v], out);
    for (;;) {
      if (const auto d = strips.go_on(b, c)) {
        put(1, patch.vertices[*d], out);
        a = b;
        b = c;
        c = *d;
      } else if (const auto e = strips.go_on(a, c)) {
        put(2, patch.vertices[*e], out);
        b = c;
        c = *e;
      } else {
        break;
      }
    }
  }
}

}  // namespace knotreel::exporting
