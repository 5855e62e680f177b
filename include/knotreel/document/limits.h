// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace knotreel::document {

/// Knots of a document lie on a grid of 2^-bits px.
inline constexpr int kMinKnotBits = 0;
inline constexpr int kMaxKnotBits = 14;

}  // namespace knotreel::document
