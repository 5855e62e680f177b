// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

namespace knotreel::cli {

/// "; did you mean 'render'?" if one of some names is nearly the given one (the first of the nearest), else
/// nothing.
std::string suggestion(const std::string& given, std::span<const std::string> names);

}  // namespace knotreel::cli
