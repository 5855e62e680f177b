// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/multigrid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "knotreel/base/parallel.h"

namespace knotreel::param {
namespace {

/// Sums of edge weights over the two edges between aggregates count half: the distance is doubled too.
constexpr float kEdgeScale = 0.5F;
constexpr int kCoarsest = 3;  // cells across at which no coarser level is made
constexpr int kCoarsestSweeps = 8;
constexpr int kSweepsDown = 1;
constexpr int kSweepsUp = 2;
constexpr int kMostCycles = 60;
/// Times the decay: farther from what is given anew hardly anything changes. Where it does, it is noticed.
constexpr double kReach = 4;
/// Of the tolerance: tiles that change by less, with their neighbours, are left alone.
constexpr float kSettled = 0.25F;

/// Calls body(y, begin, end, tile) for the rows of cells of all tiles; each row of tiles is on one thread.
template <typename Body>
void for_rows(const Tiles& tiles, int width, int height, const Body& body) {
  const auto task = [&](std::size_t i) {
    const int row = static_cast<int>(i);
    const int end = std::min(height, (row + 1) * Tiles::kSide);
    for (int y = row * Tiles::kSide; y < end; ++y) {
      for (int column = 0; column < tiles.columns(); ++column) {
        if (!tiles.has(column, row)) continue;
        const int x = column * Tiles::kSide;
        body(y, x, std::min(width, x + Tiles::kSide), tiles.index(column, row));
      }
    }
  };
  if (tiles.rows() == 1) {
    task(0);
  } else {
    parallel_for(static_cast<std::size_t>(tiles.rows()), task);
  }
}

Quad larger(Quad most, Quad change) {
  const Quad size = change < 0 ? -change : change;
  return size > most ? size : most;
}

/// Half a Gauss-Seidel sweep along a row of the finest level: the pixels of one colour of the checkerboard.
/// @return largest change.
float relax_row(Framed<Quad>& field, const Framed<float>& inverse, int y, int begin, int end, int colour) {
  Quad* u = field.row(y);
  const Quad* above = field.row(y - 1);
  const Quad* below = field.row(y + 1);
  const float* inv = inverse.row(y);
  Quad most{};
  for (int x = begin + ((begin + y + colour) & 1); x < end; x += 2) {
    if (inv[x] == 0) continue;
    const Quad next = ((u[x - 1] + u[x + 1]) + (above[x] + below[x])) * inv[x];
    most = larger(most, next - u[x]);
    u[x] = next;
  }
  return largest(most);
}

/// Sum over the edges of a cell of weight times value beyond.
Quad neighbours(const Framed<Quad>& value, const Framed<float>& right, const Framed<float>& down, int x,
                int y) {
  const Quad* u = value.row(y);
  const float* r = right.row(y);
  return (u[x - 1] * r[x - 1] + u[x + 1] * r[x]) +
         (value.row(y - 1)[x] * down.row(y - 1)[x] + value.row(y + 1)[x] * down.row(y)[x]);
}

}  // namespace

ScreenedTutte::ScreenedTutte(int width, int height, const std::vector<std::uint8_t>& fixed, double decay)
    : reach_(static_cast<int>(std::ceil(kReach * decay / Tiles::kSide))) {
  Level finest;
  finest.width = width;
  finest.height = height;
  finest.active = Tiles(width, height);
  finest.inverse = Framed<float>(width, height);
  finest.ground = Framed<float>(width, height);
  finest.right = Framed<float>(width, height);
  finest.down = Framed<float>(width, height);
  const auto screening = static_cast<float>(decay > 0 ? 1 / (decay * decay) : 0.0);
  const auto is_fixed = [&](int x, int y) {
    return fixed[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(x)] != 0;
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (is_fixed(x, y)) continue;
      float ground = screening;
      const auto tie = [&](bool beyond_border, int nx, int ny) {
        if (beyond_border) {
          ground += 2;
        } else if (is_fixed(nx, ny)) {
          ground += 1;
        }
      };
      tie(x == 0, x - 1, y);
      tie(x + 1 == width, x + 1, y);
      tie(y == 0, x, y - 1);
      tie(y + 1 == height, x, y + 1);
      finest.ground.at(x, y) = ground;
      if (x + 1 < width && !is_fixed(x + 1, y)) finest.right.at(x, y) = 1;
      if (y + 1 < height && !is_fixed(x, y + 1)) finest.down.at(x, y) = 1;
    }
  }
  set_inverse(finest);
  levels_.push_back(std::move(finest));
  while (std::max(levels_.back().width, levels_.back().height) > kCoarsest) {
    levels_.push_back(coarsen(levels_.back()));
  }
}

ScreenedTutte::Level ScreenedTutte::coarsen(const Level& fine) {
  Level level;
  level.width = (fine.width + 1) / 2;
  level.height = (fine.height + 1) / 2;
  level.active = Tiles(level.width, level.height);
  level.inverse = Framed<float>(level.width, level.height);
  level.ground = Framed<float>(level.width, level.height);
  level.right = Framed<float>(level.width, level.height);
  level.down = Framed<float>(level.width, level.height);
  level.value = Framed<Quad>(level.width, level.height);
  level.rhs = Framed<Quad>(level.width, level.height);
  for (int y = 0; y < level.height; ++y) {
    // Odd sizes: the second child may be of the frame, whose weights are zero.
    const int fy = 2 * y;
    for (int x = 0; x < level.width; ++x) {
      const int fx = 2 * x;
      level.ground.at(x, y) = (fine.ground.at(fx, fy) + fine.ground.at(fx + 1, fy)) +
                              (fine.ground.at(fx, fy + 1) + fine.ground.at(fx + 1, fy + 1));
      level.right.at(x, y) = kEdgeScale * (fine.right.at(fx + 1, fy) + fine.right.at(fx + 1, fy + 1));
      level.down.at(x, y) = kEdgeScale * (fine.down.at(fx, fy + 1) + fine.down.at(fx + 1, fy + 1));
    }
  }
  set_inverse(level);
  return level;
}

void ScreenedTutte::set_inverse(Level& level) {
  for (int y = 0; y < level.height; ++y) {
    for (int x = 0; x < level.width; ++x) {
      const float diagonal = level.ground.at(x, y) + (level.right.at(x - 1, y) + level.right.at(x, y)) +
                             (level.down.at(x, y - 1) + level.down.at(x, y));
      level.inverse.at(x, y) = diagonal > 0 ? 1 / diagonal : 0;
    }
  }
}

/// Coarse cells elsewhere are zero: corrections end there.
void ScreenedTutte::activate(Tiles tiles) {
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    if (l > 0) {
      tiles = tiles.halved(level.width, level.height);
      for_rows(level.active, level.width, level.height, [&](int y, int begin, int end, std::size_t) {
        std::fill(level.value.row(y) + begin, level.value.row(y) + end, Quad{});
      });
    }
    level.active = tiles;
  }
}

void ScreenedTutte::relax(Framed<Quad>& field, std::size_t index, int sweeps) {
  Level& level = levels_[index];
  for (int half = 0; half < 2 * sweeps; ++half) {
    for_rows(level.active, level.width, level.height, [&](int y, int begin, int end, std::size_t tile) {
      if (index == 0) {
        changes_[tile] = std::max(changes_[tile], relax_row(field, level.inverse, y, begin, end, half & 1));
        return;
      }
      Quad* u = level.value.row(y);
      const float* inv = level.inverse.row(y);
      const Quad* b = level.rhs.row(y);
      for (int x = begin + ((begin + y + half) & 1); x < end; x += 2) {
        u[x] = (b[x] + neighbours(level.value, level.right, level.down, x, y)) * inv[x];
      }
    });
  }
}

/// Residual of a level, summed over the cells of the next one.
void ScreenedTutte::restrict_residual(const Framed<Quad>& field, std::size_t index) {
  const Level& fine = levels_[index];
  Level& coarse = levels_[index + 1];
  const auto residual = [&](int x, int y) {
    const float inv = fine.inverse.at(x, y);
    if (inv == 0) return Quad{};
    if (index > 0) {
      return fine.rhs.at(x, y) + neighbours(fine.value, fine.right, fine.down, x, y) -
             fine.value.at(x, y) / inv;
    }
    const Quad* u = field.row(y);
    return ((u[x - 1] + u[x + 1]) + (field.at(x, y - 1) + field.at(x, y + 1))) - u[x] / inv;
  };
  for_rows(coarse.active, coarse.width, coarse.height, [&](int y, int begin, int end, std::size_t) {
    Quad* b = coarse.rhs.row(y);
    Quad* e = coarse.value.row(y);
    // After a sweep the cells of the second colour have no residual left: only the first one is summed.
    for (int x = begin; x < end; ++x) {
      b[x] = residual(2 * x, 2 * y) + residual(2 * x + 1, 2 * y + 1);
      e[x] = Quad{};
    }
  });
}

/// Adds the correction of the next level, bilinearly between the centres of its cells.
void ScreenedTutte::prolong(Framed<Quad>& field, std::size_t index) {
  Level& fine = levels_[index];
  const Level& coarse = levels_[index + 1];
  Framed<Quad>& target = index == 0 ? field : fine.value;
  for_rows(fine.active, fine.width, fine.height, [&](int y, int begin, int end, std::size_t tile) {
    const Quad* near = coarse.value.row(y / 2);
    const Quad* far = coarse.value.row(y / 2 + ((y & 1) != 0 ? 1 : -1));
    const float* inv = fine.inverse.row(y);
    Quad* u = target.row(y);
    Quad most{};
    for (int x = begin; x < end; ++x) {
      if (inv[x] == 0) continue;
      const int c = x / 2;
      const int d = c + ((x & 1) != 0 ? 1 : -1);
      const Quad e = near[c] * 0.5625F + (near[d] + far[c]) * 0.1875F + far[d] * 0.0625F;
      most = larger(most, e);
      u[x] += e;
    }
    if (index == 0) changes_[tile] = std::max(changes_[tile], largest(most));
  });
}

void ScreenedTutte::cycle(Framed<Quad>& field) {
  const std::size_t coarsest = levels_.size() - 1;
  for (std::size_t l = 0; l < coarsest; ++l) {
    relax(field, l, kSweepsDown);
    restrict_residual(field, l);
  }
  relax(field, coarsest, kCoarsestSweeps);
  for (std::size_t l = coarsest; l-- > 0;) {
    prolong(field, l);
    relax(field, l, kSweepsUp);
  }
}

int ScreenedTutte::solve(Framed<Quad>& field, double tolerance, std::span<const std::int32_t> changed) {
  const Tiles none(levels_.front().width, levels_.front().height);
  Tiles tiles = none;
  for (const std::int32_t pixel : changed)
    tiles.add_cell(pixel % levels_.front().width, pixel / levels_.front().width);
  tiles = tiles.grown(reach_);
  if (reach_ == 0) tiles.add_all();
  touched_ = tiles;
  int cycles = 0;
  while (cycles < kMostCycles && tiles.any()) {
    activate(tiles);
    changes_.assign(none.count(), 0.0F);
    cycle(field);
    ++cycles;
    if (!(*std::max_element(changes_.begin(), changes_.end()) > tolerance)) break;
    if (reach_ == 0) continue;
    tiles = none;
    for (int y = 0; y < none.rows(); ++y) {
      for (int x = 0; x < none.columns(); ++x) {
        if (changes_[none.index(x, y)] > kSettled * tolerance) tiles.add(x, y);
      }
    }
    tiles = tiles.grown(1);
    touched_.add(tiles);
  }
  return cycles;
}

}  // namespace knotreel::param
