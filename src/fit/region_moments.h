#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "knotreel/base/vec2.h"

/// Sums over all pixels of a convex region, in time that goes with its rows.
namespace knotreel::fit {

/// c + x (ux - ox) + y (uy - oy) with a common origin o: what pieces are made of, so that they can be
/// subtracted.
struct Plane {
  double c = 0;
  double x = 0;
  double y = 0;
};

inline Plane operator-(const Plane& a, const Plane& b) {
  return {a.c - b.c, a.x - b.x, a.y - b.y};
}

/// One number per channel; those that a picture does not have are zero.
using Channels = std::array<double, 4>;

/// Sums over pixels of a quantity and of its products with the coordinates, relative to an origin.
struct Moments {
  Channels one{}, x{}, y{}, xx{}, xy{}, yy{};
};

/// Running sums of a quantity, and of it times x and x^2, along rows of pixels: their sums over a run of
/// pixels are differences of two of these.
class RunningSums {
 public:
  /// Sums over the pixels before this one in its row.
  struct Sums {
    Channels one, x, xx;
  };

  /// @param channels row-major, up to four. @param cell_width of a pixel. For the rows [begin, end).
  RunningSums(std::span<const std::vector<float>> channels, int width, int begin, int end, double cell_width);

  int begin() const { return begin_; }
  int end() const { return end_; }

  /// width + 1 sums.
  const Sums* row(int y) const {
    return sums_.get() + static_cast<std::size_t>(y - begin_) * (static_cast<std::size_t>(width_) + 1);
  }

 private:
  int width_;
  int begin_;
  int end_;
  std::unique_ptr<Sums[]> sums_;  ///< not a vector, which would be zeroed first
};

/// Pixels of columns [left, right) at whose centres up to eight planes are positive.
class Region {
 public:
  Region() = default;  ///< none
  /// @param cell_width of a pixel. @param origin of the planes.
  Region(int left, int right, double cell_width, Vec2 origin)
      : left_(left), right_(right), cell_width_(cell_width), origin_x_(origin.x) {}

  /// Leaves the pixels where the plane is not positive out. The regions of a plane and of its negative share
  /// no pixel and leave none out: pixels on the line between them are all on the same side.
  void cut(const Plane& plane);

  /// Adds the pixels of a row. @param y of the row, relative to the origin.
  void add_row(const RunningSums::Sums* sums, double y, Moments& moments) const;

 private:
  /// The column where a plane is zero: at + by_y * y.
  struct Bound {
    double at;
    double by_y;
  };
  static constexpr std::size_t kMost = 8;

  int left_ = 0;
  int right_ = 0;
  double cell_width_ = 1;
  double origin_x_ = 0;
  std::size_t lower_count_ = 0;
  std::size_t upper_count_ = 0;
  std::array<Bound, kMost> lower_{};
  std::array<Bound, kMost> upper_{};
};

}  // namespace knotreel::fit
