// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace knotreel::cli {

/// A text that may hold anything, such as the name of a file or what a video says of itself, as a part of a
/// line: control characters, with which a terminal can be made to do a lot, become '?'.
std::string printable(std::string text);

/// "1 frame", "2 frames". @param thing  takes an s for more than one.
std::string counted(std::uint64_t count, const std::string& thing);

}  // namespace knotreel::cli
