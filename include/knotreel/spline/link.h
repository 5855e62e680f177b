// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/base/vec2.h"

/// Triangulations of link polygons and their codes (docs/format.md, "link codes").
namespace knotreel::spline {

/// A triangle of a polygon, by the places of its corners in the polygon, ascending.
using PolygonTriangle = std::array<std::uint32_t, 3>;

/// Apex codes of a triangulation of a polygon with n corners: starting with the edge (0, n-1), the triangle
/// on an edge (i, j) has its third corner k in between; the code is k - (i + 1); then follow the codes of (i,
/// k) and of (k, j). Edges with j - i <= 2 leave no choice and have no code.
/// @param triangles n - 2 triangles that triangulate the polygon combinatorially.
void encode_triangulation(std::size_t n, std::span<const PolygonTriangle> triangles,
                          std::vector<std::uint16_t>& codes);

/// Inverse of encode_triangulation: reads as many codes as the polygon needs.
/// @return the number of codes read, or nothing if they end too early or are out of range; the triangles are
/// appended in the order of the codes.
std::optional<std::size_t> decode_triangulation(std::size_t n, std::span<const std::uint16_t> codes,
                                                std::vector<PolygonTriangle>& triangles);

/// Triangulates a simple polygon given in positive order, by cutting the ear with the largest smallest angle
/// each time. Where rounding or a non-simple polygon leaves no proper ear, the flattest one is cut.
/// O(n^2) but for polygons made to be hard; n is about 6.
/// @throws Error{kInvalidArgument} for more than 4096 corners.
std::vector<PolygonTriangle> triangulate_polygon(std::span<const Vec2> polygon);

}  // namespace knotreel::spline
