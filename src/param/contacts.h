// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "knotreel/base/vec2.h"

namespace knotreel::param {

/// A straight piece between two sites (or other numbered points).
struct Piece {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  Vec2 a;
  Vec2 b;
};

/// All pairs of pieces that cross, touch or overlap but at a common end, by index, each once and in a fixed
/// order. Rounding may add pairs that nearly touch, and loses none. About O(n) for short pieces.
/// @param slack pieces as near as that touch, too; those with a common end where the other end of one of them
///              is as near to the other piece.
std::vector<std::pair<std::uint32_t, std::uint32_t>> find_contacts(const std::vector<Piece>& pieces,
                                                                   double slack = 0);

}  // namespace knotreel::param
