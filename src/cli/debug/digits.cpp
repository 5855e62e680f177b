// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/debug/digits.h"

#include <cstddef>

namespace knotreel::cli::debug {
namespace {

constexpr std::array<Glyph, 10> kDigits{{
    {" ### ", "#   #", "#   #", "#   #", "#   #", "#   #", " ### "},
    {"  #  ", " ##  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "},
    {" ### ", "#   #", "    #", "   # ", "  #  ", " #   ", "#####"},
    {" ### ", "#   #", "    #", "  ## ", "    #", "#   #", " ### "},
    {"   # ", "  ## ", " # # ", "#  # ", "#####", "   # ", "   # "},
    {"#####", "#    ", "#### ", "    #", "    #", "#   #", " ### "},
    {" ### ", "#    ", "#    ", "#### ", "#   #", "#   #", " ### "},
    {"#####", "    #", "   # ", "  #  ", "  #  ", " #   ", " #   "},
    {" ### ", "#   #", "#   #", " ### ", "#   #", "#   #", " ### "},
    {" ### ", "#   #", "#   #", " ####", "    #", "    #", " ### "},
}};
constexpr Glyph kStop{"     ", "     ", "     ", "     ", "     ", " ##  ", " ##  "};
constexpr Glyph kBlank{"     ", "     ", "     ", "     ", "     ", "     ", "     "};

}  // namespace

const Glyph& digit_glyph(char c) {
  if (c >= '0' && c <= '9') return kDigits[static_cast<std::size_t>(c - '0')];
  return c == '.' ? kStop : kBlank;
}

}  // namespace knotreel::cli::debug
