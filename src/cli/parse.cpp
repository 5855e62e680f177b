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

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& wanted) {
  throw Error(ErrorKind::kInvalidArgument, option + " takes " + wanted + ", not '" + text + "'");
}

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

std::array<float, 3> parse_colour(const std::string& option, const std::string& text) {
  if (text == "black") return {0, 0, 0};
  if (text == "white") return {255, 255, 255};
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
    refuse(option, text, "black, white, #rrggbb or R,G,B with values from 0 to 255");
  return {static_cast<float>(values[0]), static_cast<float>(values[1]), static_cast<float>(values[2])};
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

}  // namespace knotreel::cli
