#include "export/svg_text.h"

#include <algorithm>
#include <cmath>

#include "export/number_text.h"

namespace knotreel::exporting {

namespace {

constexpr double kUnit = 100;  // coordinates are whole multiples of 1 / kUnit px
// A cubic whose control points are those of a quadratic, to this many pixels, is written as one.
constexpr double kQuadratic = 0.005;

class PathWriter {
 public:
  void add(const Loop& outline) {
    at_ = rounded(outline.front()[0]);
    text_ += 'M';
    put(at_.x);
    put(at_.y);
    for (const Curve& c : outline) add(c);
    text_ += 'z';
  }

  std::string take() { return std::move(text_); }

 private:
  struct Point {
    long x = 0, y = 0;
    bool operator==(const Point&) const = default;
  };

  static Point rounded(Vec2 p) { return {std::lround(p.x * kUnit), std::lround(p.y * kUnit)}; }

  void add(const Curve& c) {
    const Point end = rounded(c[3]);
    if (is_straight(c)) {
      if (end == at_) return;
      if (end.y == at_.y) {
        text_ += 'h';
        put(end.x - at_.x);
      } else if (end.x == at_.x) {
        text_ += 'v';
        put(end.y - at_.y);
      } else {
        text_ += 'l';
        put_relative(end);
      }
    } else {
      const Vec2 from = c[0] + 1.5 * (c[1] - c[0]);
      const Vec2 to = c[3] + 1.5 * (c[2] - c[3]);
      if (norm(from - to) <= kQuadratic) {
        text_ += 'q';
        put_relative(rounded(0.5 * (from + to)));
      } else {
        text_ += 'c';
        put_relative(rounded(c[1]));
        put_relative(rounded(c[2]));
      }
      put_relative(end);
    }
    at_ = end;
  }

  void put_relative(Point p) {
    put(p.x - at_.x);
    put(p.y - at_.y);
  }

  /// Numbers need no space before a minus or behind a letter.
  void put(long hundredths) {
    const char last = text_.back();
    if (hundredths >= 0 && (last == '.' || (last >= '0' && last <= '9'))) text_ += ' ';
    append_number(text_, double(hundredths) / kUnit, 2);
  }

  std::string text_;
  Point at_;
};

}  // namespace

std::string colour_text(const Rgb& colour, std::size_t channels) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text = "#";
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = colour[channels == 3 ? c : 0];
    const auto level = static_cast<unsigned>(std::lround(std::clamp(value, 0.0, 255.0)));
    text += kDigits[level >> 4];
    text += kDigits[level & 15];
  }
  if (text[1] == text[2] && text[3] == text[4] && text[5] == text[6]) text = {'#', text[1], text[3], text[5]};
  return text;
}

std::string path_data(const std::vector<Loop>& outlines) {
  PathWriter writer;
  for (const Loop& outline : outlines) writer.add(outline);
  return writer.take();
}

std::string gradient_text(const std::string& id, const Region& region, std::size_t channels) {
  const Paint& paint = region.paint;
  const Vec2 from = paint.centre + region.from * paint.direction;
  const Vec2 to = paint.centre + region.to * paint.direction;
  const int decimals = region.to - region.from < 4 ? 3 : 2;
  std::string text = "<linearGradient id=\"" + id + "\" gradientUnits=\"userSpaceOnUse\" x1=\"";
  append_number(text, from.x, decimals);
  text += "\" y1=\"";
  append_number(text, from.y, decimals);
  text += "\" x2=\"";
  append_number(text, to.x, decimals);
  text += "\" y2=\"";
  append_number(text, to.y, decimals);
  Rgb first{}, last{};
  for (std::size_t c = 0; c < channels; ++c) {
    first[c] = paint.at(from, c);
    last[c] = paint.at(to, c);
  }
  return text + "\"><stop stop-color=\"" + colour_text(first, channels) +
         "\"/><stop offset=\"1\" stop-color=\"" + colour_text(last, channels) + "\"/></linearGradient>\n";
}

}  // namespace knotreel::exporting
