// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/multigrid.h"

#include <algorithm>
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
constexpr int kRowsPerTask = 16;

/// Largest of body(y) over the rows of a grid; neighbouring rows are on one thread.
template <typename Body>
float for_rows(int height, const Body& body) {
  const auto tasks = static_cast<std::size_t>((height + kRowsPerTask - 1) / kRowsPerTask);
  std::vector<float> most(tasks, 0.0F);
  const auto task = [&](std::size_t i) {
    const int first = static_cast<int>(i) * kRowsPerTask;
    const int end = std::min(height, first + kRowsPerTask);
    for (int y = first; y < end; ++y) most[i] = std::max(most[i], body(y));
  };
  if (tasks == 1) {
    task(0);
  } else {
    parallel_for(tasks, task);
  }
  return *std::max_element(most.begin(), most.end());
}

Quad larger(Quad most, Quad change) {
  const Quad size = change < 0 ? -change : change;
  return size > most ? size : most;
}

/// Half a Gauss-Seidel sweep along a row of the finest level: the pixels of one colour of the checkerboard.
/// @return largest change.
float relax_row(Framed<Quad>& field, const Framed<float>& inverse, int width, int y, int colour) {
  Quad* u = field.row(y);
  const Quad* above = field.row(y - 1);
  const Quad* below = field.row(y + 1);
  const float* inv = inverse.row(y);
  Quad most{};
  for (int x = (y + colour) & 1; x < width; x += 2) {
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

ScreenedTutte::ScreenedTutte(int width, int height, const std::vector<std::uint8_t>& fixed, double decay) {
  Level finest;
  finest.width = width;
  finest.height = height;
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

float ScreenedTutte::relax(Framed<Quad>& field, std::size_t index, int sweeps) {
  Level& level = levels_[index];
  float change = 0;
  for (int half = 0; half < 2 * sweeps; ++half) {
    const float most = for_rows(level.height, [&](int y) {
      if (index == 0) return relax_row(field, level.inverse, level.width, y, half & 1);
      Quad* u = level.value.row(y);
      const float* inv = level.inverse.row(y);
      const Quad* b = level.rhs.row(y);
      for (int x = (y + half) & 1; x < level.width; x += 2) {
        u[x] = (b[x] + neighbours(level.value, level.right, level.down, x, y)) * inv[x];
      }
      return 0.0F;
    });
    change = std::max(change, most);
  }
  return change;
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
  for_rows(coarse.height, [&](int y) {
    Quad* b = coarse.rhs.row(y);
    Quad* e = coarse.value.row(y);
    // After a sweep the cells of the second colour have no residual left: only the first one is summed.
    for (int x = 0; x < coarse.width; ++x) {
      b[x] = residual(2 * x, 2 * y) + residual(2 * x + 1, 2 * y + 1);
      e[x] = Quad{};
    }
    return 0.0F;
  });
}

/// Adds the correction of the next level, bilinearly between the centres of its cells.
float ScreenedTutte::prolong(Framed<Quad>& field, std::size_t index) {
  Level& fine = levels_[index];
  const Level& coarse = levels_[index + 1];
  Framed<Quad>& target = index == 0 ? field : fine.value;
  return for_rows(fine.height, [&](int y) {
    const Quad* near = coarse.value.row(y / 2);
    const Quad* far = coarse.value.row(y / 2 + ((y & 1) != 0 ? 1 : -1));
    const float* inv = fine.inverse.row(y);
    Quad* u = target.row(y);
    Quad most{};
    for (int x = 0; x < fine.width; ++x) {
      if (inv[x] == 0) continue;
      const int c = x / 2;
      const int d = c + ((x & 1) != 0 ? 1 : -1);
      const Quad e = near[c] * 0.5625F + (near[d] + far[c]) * 0.1875F + far[d] * 0.0625F;
      most = larger(most, e);
      u[x] += e;
    }
    return largest(most);
  });
}

int ScreenedTutte::solve(Framed<Quad>& field, double tolerance) {
  int cycles = 0;
  while (cycles < kMostCycles) {
    float change = 0;
    const std::size_t coarsest = levels_.size() - 1;
    for (std::size_t l = 0; l < coarsest; ++l) {
      change = std::max(change, relax(field, l, kSweepsDown));
      restrict_residual(field, l);
    }
    change = std::max(change, relax(field, coarsest, kCoarsestSweeps));
    for (std::size_t l = coarsest; l-- > 0;) {
      const float correction = prolong(field, l);
      const float sweep = relax(field, l, kSweepsUp);
      if (l == 0) change = std::max({change, correction, sweep});
    }
    ++cycles;
    if (!(change > tolerance)) break;
  }
  return cycles;
}

}  // namespace knotreel::param
