// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/number_text.h"

#include <array>
#include <charconv>

namespace knotreel::exporting {

void append_number(std::string& text, double value, int decimals) {
  std::array<char, 64> digits;
  // Not printf, which would write a comma where the locale says so.
  auto [end, error] =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals);
  if (error != std::errc()) {
    text += '0';
    return;
  }
  if (decimals > 0) {
    while (end[-1] == '0') --end;
    if (end[-1] == '.') --end;
  }
  std::string_view shown(digits.data(), static_cast<std::size_t>(end - digits.data()));
  text += shown == "-0" ? "0" : shown;
}

std::string number_text(double value, int decimals) {
  std::string text;
  append_number(text, value, decimals);
  return text;
}

}  // namespace knotreel::exporting
