#pragma once

#include <string>

namespace knotreel::cli {

/// A text that may hold anything, such as the name of a file or what a video says of itself, as a part of a
/// line: control characters, with which a terminal can be made to do a lot, become '?'.
std::string printable(std::string text);

}  // namespace knotreel::cli
