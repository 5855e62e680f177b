// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

/// Standard error as it was when the program began: codecs make its descriptor mute for all threads while
/// they are at work (image/quiet.h), and what the program has to say must not be lost meanwhile.
namespace knotreel::cli {

/// Takes the terminal's cursor to the start of an empty line.
inline constexpr const char* kClearLine = "\r\x1b[K";

/// To be called first of all, from main().
void keep_standard_error();

bool standard_error_is_terminal();

/// What cannot be shown is no reason to stop: there is nobody left to tell.
void put_error(const std::string& text);

/// "knotreel: MESSAGE", one line whatever is in it.
void put_error_line(const std::string& message);

}  // namespace knotreel::cli
