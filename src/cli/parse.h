#pragma once

#include <array>
#include <cstdint>
#include <string>

/// Texts of options -> values. All throw Error{kInvalidArgument} with the option's name and what it takes.
namespace knotreel::cli {

struct Size {
  int width = 0;
  int height = 0;
};

/// "640x360", both at least 1.
Size parse_size(const std::string& option, const std::string& text);

struct Rect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// "X,Y,W,H"; X and Y at least 0, W and H at least 1.
Rect parse_rect(const std::string& option, const std::string& text);

/// "black", "white", "#rrggbb" or "R,G,B" with 0 <= R, G, B <= 255.
std::array<float, 3> parse_colour(const std::string& option, const std::string& text);

/// A count such as "3000", or a share such as "2.5%" of `whole`; the result is at least 1.
std::uint64_t parse_count(const std::string& option, const std::string& text, std::uint64_t whole);

}  // namespace knotreel::cli
