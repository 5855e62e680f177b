// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "document/plain_recurrence.h"

/// A second reader of still documents, written from docs/format.md. Shares no code with the library and is
/// meant to be read beside that page: it proves that the page is complete. Throws std::runtime_error for what
/// is wrong, but does not guard against hostile input.
namespace knotreel::testing {

struct IndependentModel {
  int width = 0;
  int height = 0;
  int channels = 0;
  int degree = 0;
  double edge_softness = 0;
  std::vector<Point> knots;
  std::vector<std::uint32_t> ids;
  std::vector<std::array<int, 3>> faces;
  std::vector<std::vector<int>> segments;

  struct Config {
    std::array<int, 3> triangle;
    std::vector<int> inner;
  };
  std::vector<int> knot_of_corner;
  std::vector<Config> configs;               ///< of level degree - 1
  std::vector<std::vector<int>> functions;   ///< corners, ascending
  std::vector<std::vector<double>> control;  ///< x, y, colours

  /// S(u) at a point off all knot lines.
  std::vector<double> surface(Point u) const;
};

IndependentModel read_independently(const std::vector<std::byte>& file);

}  // namespace knotreel::testing
