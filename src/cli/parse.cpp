// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/parse.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "knotreel/base/error.h"

namespace knotreel::cli {
namespace {

template <typename Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Whole numbers between separators; empty if anything else is in the text.
std::vector<int> numbers(std::string_view text, char separator) {
  std::vector<int> values;
  while (true) {
    const std::size_t end = text.find(separator);
    const auto value = number<int>(text.substr(0, end));
    if (!value) return {};
    values.push_back(*value);
    if (end == std::string_view::npos) return values;
    text.remove_prefix(end + 1);
  }
}

}  // namespace

void refuse(const std::string& option, const std::string& text, const std::string& wanted) {
  throw Error(ErrorKind::kInvalidArgument, option + " takes " + wanted + ", not '" + text + "'");
}

Size parse_size(const std::string& option, const std::string& text) {
  const std::vector<int> values = numbers(text, 'x');
  if (values.size() != 2 || values[0] < 1 || values[1] < 1) refuse(option, text, "a size such as 1920x1080");
  return {values[0], values[1]};
}

Rect parse_rect(const std::string& option, const std::string& text) {
  const std::vector<int> v = numbers(text, ',');
  if (v.size() != 4 || v[0] < 0 || v[1] < 0 || v[2] < 1 || v[3] < 1) {
    refuse(option, text, "X,Y,WIDTH,HEIGHT in output pixels, such as 0,0,200,100");
  }
  return {v[0], v[1], v[2], v[3]};
}

image::Background parse_background(const std::string& text) {
  if (text.empty()) return std::nullopt;
  if (text == "black") return {{0, 0, 0}};
  if (text == "white") return {{255, 255, 255}};
  std::vector<int> values;
  if (text.size() == 7 && text[0] == '#') {
    for (std::size_t i = 1; i < 7; i += 2) {
      unsigned value = 0;
      const char* end = text.data() + i + 2;
      if (std::from_chars(text.data() + i, end, value, 16).ptr == end)
        values.push_back(static_cast<int>(value));
    }
  } else {
    values = numbers(text, ',');
  }
  const bool in_range = std::all_of(values.begin(), values.end(), [](int v) { return v >= 0 && v <= 255; });
  if (values.size() != 3 || !in_range)
    refuse("--background", text, "black, white, #rrggbb or R,G,B with values from 0 to 255");
  return {{static_cast<float>(values[0]), static_cast<float>(values[1]), static_cast<float>(values[2])}};
}

std::uint64_t parse_count(const std::string& option, const std::string& text, std::uint64_t whole) {
  if (text.ends_with('%')) {
    const auto percent = number<double>(std::string_view(text).substr(0, text.size() - 1));
    if (percent && *percent > 0 && *percent <= 100) {
      const double share = std::round(*percent / 100 * static_cast<double>(whole));
      return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(share));
    }
  } else if (const auto count = number<std::uint64_t>(text); count && *count > 0) {
    return *count;
  }
  refuse(option, text, "a number such as 3000 or a share of the pixels such as 2% (above 0, at most 100%)");
}

video::Rational parse_rate(const std::string& option, const std::string& text) {
  const std::string_view all = text;
  const std::size_t slash = all.find('/');
  video::Rational rate;
  if (slash != std::string_view::npos) {
    rate.num = number<std::int64_t>(all.substr(0, slash)).value_or(0);
    rate.den = number<std::int64_t>(all.substr(slash + 1)).value_or(0);
  } else if (const auto value = number<double>(all); value && *value <= 100000) {
    const bool whole = *value == std::floor(*value);
    rate =
        whole ? video::Rational{std::int64_t(*value), 1} : video::Rational{std::llround(*value * 1000), 1000};
  }
  if (!rate.known() || rate.num > 0x7fffffff || rate.den > 0x7fffffff) {
    refuse(option, text, "frames per second such as 25 or 30000/1001");
  }
  return rate;
}

FrameRange parse_frames(const std::string& text) {
  constexpr const char* kWanted = "A-B, A- or A, with whole numbers, B not below A";
  const auto whole = [&](std::string_view word) {
    const auto value = number<std::uint32_t>(word);
    if (!value) refuse("--frames", text, kWanted);
    return *value;
  };
  const std::string_view all = text;
  const std::size_t dash = all.find('-');
  FrameRange range{whole(all.substr(0, dash)), {}};
  if (dash == std::string_view::npos) {
    range.last = range.first;
  } else if (dash + 1 < all.size()) {
    range.last = whole(all.substr(dash + 1));
  }
  if (range.last && *range.last < range.first) refuse("--frames", text, kWanted);
  return range;
}

double parse_time(const std::string& option, const std::string& text) {
  constexpr const char* kWanted = "seconds or [HH:]MM:SS, such as 75.5 or 1:15.5";
  constexpr double kMostSeconds = 1e9;
  std::string_view left = text;
  double seconds = 0;
  for (int parts = 1;; ++parts) {
    const std::size_t colon = left.find(':');
    const bool is_last = colon == std::string_view::npos;
    std::optional<double> value = number<double>(left.substr(0, colon));
    if (!is_last && !number<std::uint32_t>(left.substr(0, colon))) value.reset();
    const bool fits = value && *value >= 0 && *value < (parts > 1 ? 60 : kMostSeconds);
    if (!fits || (parts == 3 && !is_last)) refuse(option, text, kWanted);
    seconds = 60 * seconds + *value;
    if (is_last) return seconds;
    left.remove_prefix(colon + 1);
  }
}

}  // namespace knotreel::cli
