// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

namespace knotreel {

/// Whether a comes before b when digits count as numbers: a2 before a10.
bool natural_less(const std::string& a, const std::string& b);

/// The digits from `at` on, without leading zeros; `at` goes behind them.
std::string digits_at(const std::string& text, std::size_t& at);

}  // namespace knotreel
