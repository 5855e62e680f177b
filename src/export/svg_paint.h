#pragma once

#include <cstdint>
#include <string>

#include "knotreel/export/tessellate.h"

namespace knotreel::exporting {

/// Triangles with linear colours as SVG elements: one path each, flat or with a gradient along the direction
/// in which the colour changes most. Channels that change in other directions are why some triangles are
/// divided further.
class SvgPainter {
 public:
  /// @param first, count  the channels to show: three, or one as grey.
  /// @param gradients  how many the document has already: they are numbered through.
  SvgPainter(std::size_t first, std::size_t count, double colour_tolerance, std::uint64_t gradients)
      : first_(first), count_(count), tolerance_(colour_tolerance), gradients_(gradients) {}

  /// Appends the elements of a patch; returns how many.
  std::size_t paint(const Patch& patch, std::string& text);

  std::uint64_t gradients() const { return gradients_; }

 private:
  struct Corner {
    Vec2 x;
    std::array<double, 3> colour;
  };
  using Triangle = std::array<Corner, 3>;

  std::size_t paint(const Triangle& triangle, int divisions, std::string& text);
  void append_gradient(const Triangle& t, const Triangle& outline, Vec2 direction, std::string& text);
  std::string colour_text(const std::array<double, 3>& colour) const;

  std::size_t first_;
  std::size_t count_;
  double tolerance_;
  std::uint64_t gradients_;
};

}  // namespace knotreel::exporting
