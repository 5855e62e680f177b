#pragma once

#include <string>

namespace knotreel {

/// Whether a comes before b when digits count as numbers: a2 before a10.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace knotreel
