// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string_view>

namespace knotreel::cli::debug {

inline constexpr int kGlyphWidth = 5;
inline constexpr int kGlyphHeight = 7;

/// Rows from the top; '#' is ink.
using Glyph = std::array<std::string_view, kGlyphHeight>;

/// The shape of '0'..'9' and '.'; blank for all else.
const Glyph& digit_glyph(char c);

}  // namespace knotreel::cli::debug
