#include "export/svg_paint.h"

#include <algorithm>
#include <cmath>

#include "export/number_text.h"

namespace knotreel::exporting {

namespace {

// How far triangles reach over their edges, in pixels, so that nothing shines through between antialiased
// neighbours. 0.35 closes all gaps at the size of the picture and larger.
constexpr double kOverlap = 0.35;
// Sharp corners are moved out by no more than that, in multiples of the overlap.
constexpr double kMaxMiter = 3;
constexpr int kMaxDivisions = 6;
constexpr int kDecimals = 2;

/// The corner with its two edges moved out by kOverlap; the triangle is in positive order.
Vec2 moved_out(Vec2 before, Vec2 corner, Vec2 after) {
  const auto normal = [](Vec2 a, Vec2 b) {
    const Vec2 d = b - a;
    return (1 / std::max(norm(d), 1e-12)) * Vec2{d.y, -d.x};
  };
  const Vec2 n = normal(before, corner);
  const Vec2 m = normal(corner, after);
  const Vec2 sum = n + m;
  Vec2 miter = (1 / std::max(1 + dot(n, m), 1e-3)) * sum;
  const double length = norm(miter);
  if (length > kMaxMiter) miter = (kMaxMiter / length) * miter;
  return corner + kOverlap * miter;
}

/// The direction, of length 1, in which linear colours change most: the first eigenvector of sum g g^T over
/// the gradients g of the channels.
Vec2 steepest(double xx, double xy, double yy) {
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

std::size_t SvgPainter::paint(const Patch& patch, std::string& text) {
  std::size_t count = 0;
  for (const auto& v : patch.triangles) {
    Triangle triangle{};
    for (std::size_t i = 0; i < 3; ++i) {
      const SurfacePoint& p = patch.vertices[v[i]];
      triangle[i].x = p.x;
      for (std::size_t c = 0; c < count_; ++c) triangle[i].colour[c] = p.colour[first_ + c];
    }
    count += paint(triangle, kMaxDivisions, text);
  }
  return count;
}

std::size_t SvgPainter::paint(const Triangle& t, int divisions, std::string& text) {
  const Vec2 e1 = t[1].x - t[0].x;
  const Vec2 e2 = t[2].x - t[0].x;
  const double area2 = cross(e1, e2);
  const Vec2 centre = (1.0 / 3) * (t[0].x + t[1].x + t[2].x);
  std::array<double, 3> mean{};
  double xx = 0;
  double xy = 0;
  double yy = 0;
  std::array<Vec2, 3> gradient{};
  for (std::size_t c = 0; c < count_; ++c) {
    mean[c] = (t[0].colour[c] + t[1].colour[c] + t[2].colour[c]) / 3;
    if (std::abs(area2) < 1e-9) continue;
    const double d1 = t[1].colour[c] - t[0].colour[c];
    const double d2 = t[2].colour[c] - t[0].colour[c];
    gradient[c] = {(d1 * e2.y - d2 * e1.y) / area2, (d2 * e1.x - d1 * e2.x) / area2};
    xx += gradient[c].x * gradient[c].x;
    xy += gradient[c].x * gradient[c].y;
    yy += gradient[c].y * gradient[c].y;
  }
  const Vec2 direction = steepest(xx, xy, yy);
  double flat_error = 0;
  double gradient_error = 0;
  for (const Corner& corner : t) {
    const double along = dot(direction, corner.x - centre);
    for (std::size_t c = 0; c < count_; ++c) {
      flat_error = std::max(flat_error, std::abs(corner.colour[c] - mean[c]));
      gradient_error = std::max(gradient_error,
                                std::abs(corner.colour[c] - mean[c] - dot(gradient[c], direction) * along));
    }
  }
  const bool flat = flat_error <= tolerance_ || std::abs(area2) < 1e-9;
  if (!flat && gradient_error > tolerance_ && divisions > 0) {
    // Towards a shape in which one direction is enough: the longest edge is halved.
    std::size_t longest = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      if (norm(t[(i + 1) % 3].x - t[i].x) > norm(t[(longest + 1) % 3].x - t[longest].x)) longest = i;
    }
    const Corner& a = t[longest];
    const Corner& b = t[(longest + 1) % 3];
    const Corner& c = t[(longest + 2) % 3];
    Corner m{0.5 * (a.x + b.x), {}};
    for (std::size_t k = 0; k < count_; ++k) m.colour[k] = 0.5 * (a.colour[k] + b.colour[k]);
    return paint({a, m, c}, divisions - 1, text) + paint({m, b, c}, divisions - 1, text);
  }

  Triangle outline = t;
  for (std::size_t i = 0; i < 3; ++i) outline[i].x = moved_out(t[(i + 2) % 3].x, t[i].x, t[(i + 1) % 3].x);
  std::string fill = colour_text(mean);
  if (!flat) {
    append_gradient(t, outline, direction, text);
    fill = "url(#g" + std::to_string(gradients_++) + ")";
  }
  text += "<path fill=\"" + fill + "\" d=\"M";
  for (std::size_t i = 0; i < 3; ++i) {
    if (i > 0) text += ' ';
    append_number(text, outline[i].x.x, kDecimals);
    text += ' ';
    append_number(text, outline[i].x.y, kDecimals);
  }
  text += "z\"/>\n";
  return 1;
}

/// A gradient from the lowest to the highest corner along the direction. In units of the outline's bounding
/// box, which saves a sixth of the file; there the vector is the gradient of the same linear function.
void SvgPainter::append_gradient(const Triangle& t, const Triangle& outline, Vec2 direction,
                                 std::string& text) {
  Vec2 low = outline[0].x;
  Vec2 high = low;
  for (const Corner& c : outline) {
    low = {std::min(low.x, c.x.x), std::min(low.y, c.x.y)};
    high = {std::max(high.x, c.x.x), std::max(high.y, c.x.y)};
  }
  const Vec2 size = high - low;
  const Vec2 centre = (1.0 / 3) * (t[0].x + t[1].x + t[2].x);
  const auto along = [&](const Corner& c) { return dot(direction, c.x - centre); };
  const auto [first, last] = std::minmax({along(t[0]), along(t[1]), along(t[2])});
  const double length = std::max(last - first, 1e-9);

  // Colours at both ends by least squares over the corners: linear in `along`.
  double squares = 0;
  for (const Corner& c : t) squares += along(c) * along(c);
  std::array<double, 3> from{};
  std::array<double, 3> to{};
  for (std::size_t k = 0; k < count_; ++k) {
    double mean = 0;
    double slope = 0;
    for (const Corner& c : t) {
      mean += c.colour[k] / 3;
      slope += c.colour[k] * along(c) / std::max(squares, 1e-12);
    }
    from[k] = mean + slope * first;
    to[k] = mean + slope * last;
  }
  const Vec2 g{direction.x * size.x / length, direction.y * size.y / length};
  const Vec2 vector = (1 / dot(g, g)) * g;
  // The line in box units where `along` is `first`: through any such point.
  const Vec2 start = centre + first * direction;
  const Vec2 from_point{(start.x - low.x) / size.x, (start.y - low.y) / size.y};
  text += "<linearGradient id=\"g" + std::to_string(gradients_) + "\" x1=\"";
  append_number(text, from_point.x, 3);
  text += "\" y1=\"";
  append_number(text, from_point.y, 3);
  text += "\" x2=\"";
  append_number(text, from_point.x + vector.x, 3);
  text += "\" y2=\"";
  append_number(text, from_point.y + vector.y, 3);
  text += "\"><stop stop-color=\"" + colour_text(from) + "\"/><stop offset=\"1\" stop-color=\"" +
          colour_text(to) + "\"/></linearGradient>";
}

std::string SvgPainter::colour_text(const std::array<double, 3>& colour) const {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text = "#";
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = colour[count_ == 3 ? c : 0];
    const auto level = static_cast<unsigned>(std::lround(std::clamp(value, 0.0, 255.0)));
    text += kDigits[level >> 4];
    text += kDigits[level & 15];
  }
  return text;
}

}  // namespace knotreel::exporting
