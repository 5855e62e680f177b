// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/cell_mask.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace knotreel::features {
namespace {

constexpr unsigned kMaskSeed = 68;

CellMask random_mask(double share, std::mt19937& random) {
  CellMask mask(123, 90, false);
  for (int row = 0; row < mask.rows(); ++row)
    for (int column = 0; column < mask.columns(); ++column)
      mask.set(column, row, double(random() % 1000) < 1000 * share);
  return mask;
}

template <class Body>
void for_cells(const CellMask& mask, Body body) {
  for (int row = 0; row < mask.rows(); ++row)
    for (int column = 0; column < mask.columns(); ++column) body(column, row);
}

/// By the definition.
bool is_near(const CellMask& mask, int column, int row, int cells) {
  bool found = false;
  for_cells(mask, [&](int c, int r) {
    found = found || (mask.at(c, r) && std::max(std::abs(c - column), std::abs(r - row)) <= cells);
  });
  return found;
}

TEST(CellMask, CellsAtTheSidesMayBeSmaller) {
  const CellMask mask(17, 8, true);
  EXPECT_EQ(mask.columns(), 3);
  EXPECT_EQ(mask.rows(), 1);
  EXPECT_TRUE(mask.at_pixel(16, 7));
}

TEST(CellMask, AWiderOneHasWhatIsNear) {
  std::mt19937 random(kMaskSeed);
  for (int cells = 0; cells < 4; ++cells) {
    const CellMask mask = random_mask(0.03, random);
    const CellMask wider = mask.wider(cells);
    for_cells(mask, [&](int c, int r) { EXPECT_EQ(wider.at(c, r), is_near(mask, c, r, cells)); });
  }
}

/// As long as anything changes, marked cells near a reached one are reached.
CellMask slow_reach(const CellMask& from, const CellMask& marked, int step) {
  CellMask reached = from;
  for (bool changes = true; changes;) {
    changes = false;
    const CellMask near = reached.wider(step);
    for_cells(from, [&](int c, int r) {
      if (!marked.at(c, r) || reached.at(c, r) || !near.at(c, r)) return;
      reached.set(c, r, true);
      changes = true;
    });
  }
  return reached;
}

bool holds(const PixelBox& window, int column, int row) {
  const int x = CellMask::kSide * column, y = CellMask::kSide * row;
  return window.left <= x && x < window.right && window.top <= y && y < window.bottom;
}

TEST(CellMask, IsReachedBySteps) {
  std::mt19937 random(kMaskSeed);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kMaskSeed) + ", mask " + std::to_string(i));
    const int step = 1 + i % 3;
    const CellMask from = random_mask(0.01, random);
    const CellMask marked = random_mask(0.15, random);
    const Reached reached = reach(from, marked, step);
    const CellMask slow = slow_reach(from, marked, step);
    for_cells(from, [&](int c, int r) {
      EXPECT_EQ(reached.cells.at(c, r), slow.at(c, r));
      const bool in_box =
          std::ranges::any_of(reached.boxes, [&](const PixelBox& box) { return holds(box, c, r); });
      EXPECT_TRUE(in_box || !slow.at(c, r));
    });
  }
}

/// How many of the windows have each pixel of 100 x 80.
std::vector<int> cover_of(const std::vector<PixelBox>& windows) {
  std::vector<int> cover(100 * 80, 0);
  for (const PixelBox& w : windows)
    for (int y = w.top; y < w.bottom; ++y)
      for (int x = w.left; x < w.right; ++x) ++cover.at(std::size_t(100 * y + x));
  return cover;
}

TEST(CellMask, WindowsHoldAllBoxesAndShareNothing) {
  std::mt19937 random(kMaskSeed);
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kMaskSeed) + ", boxes " + std::to_string(i));
    std::vector<PixelBox> boxes;
    for (int k = 0; k < i % 9; ++k) {
      const int x = int(random() % 88), y = int(random() % 68);
      boxes.push_back({x, y, x + 1 + int(random() % 12), y + 1 + int(random() % 12)});
    }
    const int margin = i % 7;
    const std::vector<int> cover = cover_of(windows_around(boxes, margin, 100, 80));
    EXPECT_LE(*std::ranges::max_element(cover), 1);
    for (const PixelBox& b : boxes)
      for (int y = std::max(0, b.top - margin); y < std::min(80, b.bottom + margin); ++y)
        for (int x = std::max(0, b.left - margin); x < std::min(100, b.right + margin); ++x)
          ASSERT_EQ(cover[std::size_t(100 * y + x)], 1);
  }
}

}  // namespace
}  // namespace knotreel::features
