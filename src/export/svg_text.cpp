// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/svg_text.h"

#include <algorithm>
#include <cmath>

#include "export/number_text.h"

namespace knotreel::exporting {

namespace {

constexpr double kUnit = 100;  // coordinates are whole multiples of 1 / kUnit px
// A cubic whose control points are those of a quadratic, to this many pixels, is written as one: a tenth of
// that is what the curve moves by.
constexpr double kQuadratic = 0.1;
constexpr double kHarmless = 1;  // levels that the end of a gradient may be cut off by

class PathWriter {
 public:
  /// Nothing, if the outline has become a point or a line.
  void add(const Loop& outline) {
    const std::size_t before = text_.size();
    at_ = rounded(outline.front()[0]);
    parts_ = 0;
    text_ += 'M';
    put(at_.x);
    put(at_.y);
    for (const Curve& c : outline) add(c);
    text_ += 'z';
    if (parts_ < 3) text_.resize(before);
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
      ++parts_;
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
      parts_ += 2;
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

  /// Numbers need no space before a minus or behind a letter, nor zero before a point, nor a space before a
  /// point if the number before has one.
  void put(long hundredths) {
    std::string number;
    append_number(number, double(hundredths) / kUnit, 2);
    if (const std::size_t zero = number.find("0."); zero == 0 || (zero == 1 && number[0] == '-')) {
      number.erase(zero, 1);
    }
    const char last = text_.back();
    const bool follows = last >= '0' && last <= '9';
    if (follows && number[0] != '-' && !(number[0] == '.' && has_point_)) text_ += ' ';
    has_point_ = number.find('.') != std::string::npos;
    text_ += number;
  }

  std::string text_;
  Point at_;
  bool has_point_ = false;  ///< the last number
  int parts_ = 0;           ///< straight ones of the outline; a curve counts as two
};

struct Stop {
  double along;  ///< from the paint's centre
  std::string colour;
};

/// Both ends, and where a channel leaves 0..255: a colour that is only cut off at the ends would be another
/// one all the way between them. What is past the last change needs no stop.
std::vector<Stop> stops_of(const Region& region, std::size_t channels) {
  const Paint& paint = region.paint;
  std::vector<double> along{region.from, region.to};
  for (std::size_t c = 0; c < channels; ++c) {
    for (const double limit : {0.0, 255.0}) {
      const double s = (limit - paint.colour[c]) / paint.slope[c];
      const double end = (paint.slope[c] > 0) == (limit > 0) ? region.to : region.from;  // that is cut off
      if (s > region.from && s < region.to && std::abs((end - s) * paint.slope[c]) > kHarmless)
        along.push_back(s);
    }
  }
  std::sort(along.begin(), along.end());
  std::vector<Stop> stops;
  for (const double s : along) {
    Rgb colour{};
    for (std::size_t c = 0; c < channels; ++c) colour[c] = paint.colour[c] + paint.slope[c] * s;
    stops.push_back({s, colour_text(colour, channels)});
  }
  while (stops.size() > 2 && stops[stops.size() - 2].colour == stops.back().colour) stops.pop_back();
  const auto changes = [&](const Stop& stop) { return stop.colour != stops.front().colour; };
  const auto first = std::find_if(stops.begin(), stops.end() - 1, changes);
  if (first - stops.begin() > 1) stops.erase(stops.begin(), first - 1);
  return stops;
}

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

std::string gradient_base() {
  return "<linearGradient id=\"g\" gradientUnits=\"userSpaceOnUse\"/>\n";
}

std::string gradient_text(const std::string& id, const Region& region, std::size_t channels) {
  const Paint& paint = region.paint;
  const std::vector<Stop> stops = stops_of(region, channels);
  const double begin = stops.front().along;
  const double length = stops.back().along - begin;
  const Vec2 from = paint.centre + begin * paint.direction;
  const Vec2 to = paint.centre + stops.back().along * paint.direction;
  const int decimals = length < 4 ? 3 : 2;
  std::string text = "<linearGradient id=\"" + id + "\" xlink:href=\"#g\" x1=\"";
  append_number(text, from.x, decimals);
  text += "\" y1=\"";
  append_number(text, from.y, decimals);
  text += "\" x2=\"";
  append_number(text, to.x, decimals);
  text += "\" y2=\"";
  append_number(text, to.y, decimals);
  text += "\">";
  for (const Stop& stop : stops) {
    text += "<stop";
    if (stop.along > begin) text += " offset=\"" + number_text((stop.along - begin) / length, 3) + '"';
    text += " stop-color=\"" + stop.colour + "\"/>";
  }
  return text + "</linearGradient>\n";
}

}  // namespace knotreel::exporting
