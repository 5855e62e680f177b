// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace knotreel::exporting {

/// Appends a number with at most `decimals` decimals and no needless zeros: "12.5", "-3", "0".
void append_number(std::string& text, double value, int decimals);

/// The same as a text of its own.
std::string number_text(double value, int decimals);

}  // namespace knotreel::exporting
