// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/multigrid.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/chains.h"

namespace knotreel::param {
namespace {

struct Problem {
  int width, height;
  std::vector<std::uint8_t> fixed;
  Framed<Quad> field;
  double decay;
};

/// The same equations, written down once more, by Cholesky in double precision.
/// @return largest difference to a field, over all free pixels and components.
double error_against_direct(const Problem& p, const Framed<Quad>& solved) {
  std::vector<int> unknown(p.fixed.size(), -1);
  int n = 0;
  for (std::size_t i = 0; i < p.fixed.size(); ++i) {
    if (p.fixed[i] == 0) unknown[i] = n++;
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(n, 4);
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) {
      const int i = unknown[static_cast<std::size_t>(y * p.width + x)];
      if (i < 0) continue;
      double diagonal = p.decay > 0 ? 1 / (p.decay * p.decay) : 0;
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const int nx = x + dx;
        const int ny = y + dy;
        if (nx < 0 || ny < 0 || nx >= p.width || ny >= p.height) {
          diagonal += 2;  // to the border, half a pixel away
          continue;
        }
        diagonal += 1;
        const int k = unknown[static_cast<std::size_t>(ny * p.width + nx)];
        if (k >= 0) {
          entries.emplace_back(i, k, -1.0);
        } else {
          for (int c = 0; c < 4; ++c) b(i, c) += static_cast<double>(p.field.at(nx, ny)[c]);
        }
      }
      entries.emplace_back(i, i, diagonal);
    }
  }
  if (n == 0) return 0;
  Eigen::SparseMatrix<double> a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixXd exact = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(a).solve(b);
  double worst = 0;
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) {
      const int i = unknown[static_cast<std::size_t>(y * p.width + x)];
      for (int c = 0; i >= 0 && c < 4; ++c) {
        worst = std::max(worst, std::abs(exact(i, c) - static_cast<double>(solved.at(x, y)[c])));
      }
    }
  }
  return worst;
}

Problem chain_problem(int width, int height, int chains, unsigned seed, double decay) {
  Problem p{width, height, {}, Framed<Quad>(width, height), decay};
  p.fixed.assign(static_cast<std::size_t>(width * height), 0);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (const auto& chain : knotreel::testing::random_chains(width, height, chains, seed).chains) {
    const Quad along{unit(random), unit(random), 3 * unit(random), 3 * unit(random)};
    for (const auto& point : chain.points) {
      p.fixed[static_cast<std::size_t>(point.y * width + point.x)] = 1;
      // Constant along a chain: the smooth case, which dies off most slowly.
      p.field.at(point.x, point.y) = along;
    }
  }
  return p;
}

Problem random_problem(int width, int height, double share, unsigned seed, double decay) {
  Problem p{width, height, {}, Framed<Quad>(width, height), decay};
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      p.fixed.push_back(static_cast<double>(unit(random)) < share);
      if (p.fixed.back() != 0) {
        p.field.at(x, y) = Quad{unit(random) - 0.5F, unit(random), 3 * unit(random), -3 * unit(random)};
      }
    }
  }
  return p;
}

std::vector<std::int32_t> given_pixels(const Problem& p) {
  std::vector<std::int32_t> pixels;
  for (std::size_t i = 0; i < p.fixed.size(); ++i) {
    if (p.fixed[i] != 0) pixels.push_back(static_cast<std::int32_t>(i));
  }
  return pixels;
}

void expect_close(const Problem& p, int most_cycles) {
  Framed<Quad> field = p.field;
  const int cycles = ScreenedTutte(p.width, p.height, p.fixed, p.decay).solve(field, 1e-3, given_pixels(p));
  EXPECT_LT(error_against_direct(p, field), 1e-3) << p.width << "x" << p.height << " decay " << p.decay;
  EXPECT_LE(cycles, most_cycles) << p.width << "x" << p.height << " decay " << p.decay;
}

TEST(ScreenedTutte, AgreesWithADirectSolver) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    for (const double decay : {0.0, 3.0, 20.0, 60.0}) {
      expect_close(
          chain_problem(97 + 20 * static_cast<int>(seed), 130, 2 * static_cast<int>(seed), seed, decay), 12);
      expect_close(random_problem(60, 45, 0.02 * seed, seed, decay), 12);
    }
  }
}

TEST(ScreenedTutte, SmallGridsWork) {
  for (int width = 1; width <= 9; ++width) {
    for (int height = 1; height <= 9; ++height) {
      expect_close(random_problem(width, height, 0.3, static_cast<unsigned>(10 * width + height), 20), 12);
    }
  }
}

/// A part of a picture is solved for, once more when some of it is given anew, and the rest is left alone.
TEST(ScreenedTutte, SolvesAgainAroundWhatIsGivenAnew) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    for (const double decay : {0.0, 3.0, 8.0}) {
      Problem p = chain_problem(150, 110, 4, seed, decay);
      ScreenedTutte solver(p.width, p.height, p.fixed, p.decay);
      std::vector<std::int32_t> given = given_pixels(p);
      Framed<Quad> field = p.field;
      solver.solve(field, 1e-3, given);
      std::mt19937 random(seed);
      for (int round = 0; round < 2; ++round) {
        std::shuffle(given.begin(), given.end(), random);
        const std::vector<std::int32_t> changed(given.begin(), given.begin() + 5);
        for (const std::int32_t pixel : changed) {
          const Quad now{1, -2, 3, static_cast<float>(round)};
          p.field.at(pixel % p.width, pixel / p.width) = now;
          field.at(pixel % p.width, pixel / p.width) = now;
        }
        EXPECT_LE(solver.solve(field, 1e-3, changed), 12);
        EXPECT_LT(error_against_direct(p, field), 2e-3)
            << "seed " << seed << ", decay " << decay << ", round " << round;
      }
    }
  }
}

TEST(ScreenedTutte, LeavesWhatIsFarAwayAtRest) {
  Problem p{900, 12, std::vector<std::uint8_t>(900 * 12, 0), Framed<Quad>(900, 12), 16};
  p.fixed[6 * 900 + 100] = 1;
  p.field.at(100, 6) = Quad{3, 3, 3, 3};
  const Problem given = p;
  ScreenedTutte(p.width, p.height, p.fixed, p.decay).solve(p.field, 1e-3, given_pixels(p));
  EXPECT_LT(error_against_direct(given, p.field), 1e-3);
  for (int x = 500; x < 900; ++x) EXPECT_EQ(largest(p.field.at(x, 6)), 0) << x;
}

TEST(ScreenedTutte, NothingGivenAnewChangesNothing) {
  const Problem p = chain_problem(90, 70, 3, 5, 16);
  Framed<Quad> field = p.field;
  EXPECT_EQ(ScreenedTutte(p.width, p.height, p.fixed, p.decay).solve(field, 1e-3, {}), 0);
}

}  // namespace
}  // namespace knotreel::param
