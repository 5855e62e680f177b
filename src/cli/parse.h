// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "knotreel/image/background.h"
#include "knotreel/video/stream_info.h"

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

/// Of --background: "black", "white", "#rrggbb" or "R,G,B" with 0 <= R, G, B <= 255; empty: none.
image::Background parse_background(const std::string& text);

/// A count such as "3000", or a share such as "2.5%" of `whole`; the result is at least 1.
std::uint64_t parse_count(const std::string& option, const std::string& text, std::uint64_t whole);

/// "25", "23.976" or "30000/1001", above 0. @throws Error{kInvalidArgument} with the option's name.
video::Rational parse_rate(const std::string& option, const std::string& text);

/// Frames counted from 0, both ends included.
struct FrameRange {
  std::uint64_t first = 0;
  std::optional<std::uint64_t> last;  ///< none: up to the end
};
/// "3-7", "3-" or "3". @throws Error{kInvalidArgument} for anything else.
FrameRange parse_frames(const std::string& text);

/// Seconds, as "75.5", "1:15.5" or "0:01:15.5". @throws Error{kInvalidArgument} with the option's name.
double parse_time(const std::string& option, const std::string& text);

/// Says that an option has a wrong value. @param wanted what it takes.
[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& wanted);

}  // namespace knotreel::cli
