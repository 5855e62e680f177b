// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/target.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>

#include "knotreel/base/error.h"
#include "knotreel/mesh/predicates.h"
#include "knots/drawings.h"
#include "support/dense.h"
#include "support/mesh_cases.h"
#include "support/pictures.h"

/// Sums over triangles against sums over pixels one by one.
namespace knotreel::knots {
namespace {

constexpr std::uint64_t kTargetSeed = 20261123;

using Triangle = std::array<Vec2, 3>;

Vec2 centre(int x, int y) {
  return {x + 0.5, y + 0.5};
}

/// Whether the point lies in the closed triangle, by exact signs.
bool contains(const Triangle& t, Vec2 p) {
  return mesh::orientation(t[0], t[1], p) >= 0 && mesh::orientation(t[1], t[2], p) >= 0 &&
         mesh::orientation(t[2], t[0], p) >= 0;
}

/// Positive triangles of random corners, some of them outside the picture.
class Triangles {
 public:
  Triangles(int width, int height, std::uint64_t seed) : width_(width), height_(height), random_(seed) {}

  Triangle next() {
    std::uniform_real_distribution<double> x(-3, width_ + 3), y(-3, height_ + 3);
    Triangle t;
    for (Vec2& v : t) v = {x(random_), y(random_)};
    if (signed_area(t[0], t[1], t[2]) < 0) std::swap(t[1], t[2]);
    return t;
  }

 private:
  int width_;
  int height_;
  std::mt19937_64 random_;
};

std::vector<float> random_weights(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<float> weights(n);
  for (float& w : weights) w = random() % 3 == 0 ? 0.0F : static_cast<float>(random() % 100) / 50.0F;
  return weights;
}

Moments brute_force(const Target& target, const Triangle& t) {
  Moments m;
  for (int y = 0; y < target.image().height; ++y) {
    for (int x = 0; x < target.image().width; ++x) {
      if (!contains(t, centre(x, y))) continue;
      const double w = target.weight(x, y);
      const Vec2 u = centre(x, y);
      m.w += w;
      m.x += w * u.x;
      m.y += w * u.y;
      m.xx += w * u.x * u.x;
      m.xy += w * u.x * u.y;
      m.yy += w * u.y * u.y;
      for (int c = 0; c < target.channels(); ++c) {
        const double v = static_cast<double>(target.image().at(x, y, c));
        m.squares += w * v * v;
        m.c[std::size_t(c)] += w * v;
        m.xc[std::size_t(c)] += w * v * u.x;
        m.yc[std::size_t(c)] += w * v * u.y;
      }
    }
  }
  return m;
}

void expect_near(const Moments& a, const Moments& b, double relative) {
  const auto near = [relative](double p, double q) { EXPECT_NEAR(p, q, relative * (1 + std::abs(q))); };
  near(a.w, b.w);
  near(a.x, b.x);
  near(a.y, b.y);
  near(a.xx, b.xx);
  near(a.xy, b.xy);
  near(a.yy, b.yy);
  near(a.squares, b.squares);
  for (std::size_t c = 0; c < 4; ++c) {
    near(a.c[c], b.c[c]);
    near(a.xc[c], b.xc[c]);
    near(a.yc[c], b.yc[c]);
  }
}

TEST(Target, MomentsAreSumsOverThePixelsInside) {
  for (int channels = 1; channels <= 4; ++channels) {
    for (const bool weighted : {false, true}) {
      const image::Image image = test::random_picture(31, 23, channels, 5);
      const Target target(image, weighted ? random_weights(31 * 23, kTargetSeed) : std::vector<float>{});
      Triangles triangles(31, 23, kTargetSeed);
      for (int i = 0; i < 50; ++i) {
        const Triangle t = triangles.next();
        SCOPED_TRACE(std::to_string(channels) + " channels, triangle " + std::to_string(i));
        expect_near(target.moments(t), brute_force(target, t), 1e-12);
        std::size_t visited = 0;
        target.for_pixels(t, [&](int x, int y) {
          EXPECT_TRUE(contains(t, centre(x, y)));
          ++visited;
        });
        EXPECT_EQ(static_cast<double>(visited), brute_force(Target(image, {}), t).w);
      }
    }
  }
}

TEST(Target, CompactOnesHaveTheSameSums) {
  for (const int width : {1, 3, 4, 30, 31, 33}) {
    for (int channels = 1; channels <= 4; ++channels) {
      for (const bool weighted : {false, true}) {
        const image::Image image = test::random_picture(width, 23, channels, 5);
        const std::vector<float> weights =
            weighted ? random_weights(image.pixel_count(), kTargetSeed) : std::vector<float>{};
        const Target fast(image, weights);
        Target compact(test::random_picture(width, 23, channels, 6), weights, Target::Storage::kCompact);
        compact.change_to(image);
        Triangles triangles(width, 23, kTargetSeed);
        for (int i = 0; i < 50; ++i) {
          const Triangle t = triangles.next();
          SCOPED_TRACE(std::to_string(channels) + " channels, triangle " + std::to_string(i));
          const Moments a = fast.moments(t);
          const Moments b = compact.moments(t);
          EXPECT_EQ(a.w, b.w);
          EXPECT_EQ(a.xx, b.xx);
          EXPECT_EQ(a.squares, b.squares);
          EXPECT_EQ(a.c, b.c);
          EXPECT_EQ(a.xc, b.xc);
          EXPECT_EQ(a.yc, b.yc);
        }
      }
    }
  }
}

/// Every pixel belongs to exactly one face, which contains it but for rounding.
void expect_partition(const mesh::KnotMesh& mesh, const Target& target) {
  const image::Image& image = target.image();
  std::vector<int> count(image.pixel_count(), 0);
  Moments sum;
  for (const mesh::Face& f : mesh.faces) {
    const Triangle t{mesh.knots[f[0]].position, mesh.knots[f[1]].position, mesh.knots[f[2]].position};
    target.for_pixels(t, [&](int x, int y) {
      ++count[std::size_t(y) * std::size_t(image.width) + std::size_t(x)];
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_GE(signed_area(t[i], t[(i + 1) % 3], centre(x, y)), -1e-9);
      }
    });
    const Moments m = target.moments(t);
    sum.w += m.w;
    sum.xy += m.xy;
    sum.squares += m.squares;
  }
  for (std::size_t i = 0; i < count.size(); ++i) {
    ASSERT_EQ(count[i], 1) << "pixel " << i % std::size_t(image.width) << ' ' << i / std::size_t(image.width);
  }
  const double w = image.width;
  const double h = image.height;
  const Moments whole = brute_force(target, {Vec2{-w, -h}, Vec2{4 * w, -h}, Vec2{-w, 4 * h}});
  EXPECT_EQ(sum.w, whole.w);
  EXPECT_NEAR(sum.xy, whole.xy, 1e-12 * whole.xy);
  EXPECT_NEAR(sum.squares, whole.squares, 1e-12 * whole.squares);
}

TEST(Target, FacesPartitionThePixels) {
  std::vector<knotreel::testing::MeshCase> cases = knotreel::testing::corpus_cases();
  for (auto& r : knotreel::testing::random_cases(kTargetSeed, 30)) cases.push_back(std::move(r));
  for (const auto& c : cases) {
    SCOPED_TRACE(c.to_text());
    const image::Image image =
        test::random_picture(static_cast<int>(c.mesh.width), static_cast<int>(c.mesh.height), 1, 7);
    expect_partition(c.mesh, Target(image, {}));
  }
}

TEST(Target, PixelCentresOnKnotsAndEdgesBelongToOneFace) {
  // All knots on pixel centres, or halfway between: every edge runs through centres.
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    mesh::KnotMesh mesh = mesh::make_domain(20, 16);
    std::vector<std::pair<int, int>> taken;
    for (int i = 0; i < 40; ++i) {
      const std::pair<int, int> at{1 + random() % 39, 1 + random() % 31};
      if (std::find(taken.begin(), taken.end(), at) != taken.end()) continue;
      taken.push_back(at);
      mesh.knots.push_back({{0.5 * at.first, 0.5 * at.second},
                            mesh::KnotKind::kFree,
                            mesh::KnotId{static_cast<std::uint32_t>(mesh.knots.size())}});
    }
    mesh::triangulate(mesh);
    expect_partition(mesh, Target(test::random_picture(20, 16, 2, 9), {}));
  }
}

/// The fit by a dense solver: rows of the pixels, and one for each slope that says that there is none.
LinearFit dense_fit(const Target& target, const Triangle& t) {
  std::vector<std::pair<int, int>> pixels;
  LinearFit fit;
  for (int y = 0; y < target.image().height; ++y) {
    for (int x = 0; x < target.image().width; ++x) {
      if (!contains(t, centre(x, y))) continue;
      pixels.emplace_back(x, y);
      fit.weight += target.weight(x, y);
      fit.centre = fit.centre + target.weight(x, y) * centre(x, y);
    }
  }
  fit.centre = (1 / fit.weight) * fit.centre;
  const auto n = static_cast<Eigen::Index>(pixels.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n + 2, 3);
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(n + 2, target.channels());
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto [x, y] = pixels[static_cast<std::size_t>(i)];
    const double root = std::sqrt(target.weight(x, y));
    const Vec2 d = centre(x, y) - fit.centre;
    a.row(i) << root, root * d.x, root * d.y;
    for (int c = 0; c < target.channels(); ++c)
      b(i, c) = root * static_cast<double>(target.image().at(x, y, c));
  }
  a(n, 1) = 1;
  a(n + 1, 2) = 1;
  const Eigen::MatrixXd solution = knotreel::testing::least_squares(a, b);
  for (int c = 0; c < target.channels(); ++c) {
    fit.value[std::size_t(c)] = solution(0, c);
    fit.gradient[std::size_t(c)] = {solution(1, c), solution(2, c)};
  }
  fit.error = (knotreel::testing::product(a, solution) - b).squaredNorm();
  return fit;
}

TEST(Target, FitEqualsADenseSolver) {
  for (int channels = 1; channels <= 4; ++channels) {
    for (const bool weighted : {false, true}) {
      const Target target(test::random_picture(31, 23, channels, 5),
                          weighted ? random_weights(31 * 23, kTargetSeed) : std::vector<float>{});
      Triangles triangles(31, 23, kTargetSeed + 1);
      for (int i = 0; i < 40; ++i) {
        const Triangle t = triangles.next();
        if (brute_force(target, t).w <= 0) continue;
        SCOPED_TRACE(std::to_string(channels) + " channels, triangle " + std::to_string(i));
        const LinearFit fit = target.fit(t);
        const LinearFit expected = dense_fit(target, t);
        EXPECT_NEAR(fit.weight, expected.weight, 1e-9);
        EXPECT_NEAR(fit.error, expected.error, 1e-9 * target.moments(t).squares);
        EXPECT_EQ(fit.error, target.error(t));
        for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
          EXPECT_NEAR(norm(fit.gradient[c] - expected.gradient[c]), 0, 1e-7);
          for (const Vec2 u : t) EXPECT_NEAR(fit.at(u, c), expected.at(u, c), 1e-6);
        }
      }
    }
  }
}

TEST(Target, LinearPicturesHaveNoErrorButForTheRidge) {
  const double slopes[4][2] = {{1.5, -0.5}, {0, 2}, {-1, 1}, {0.25, 0.75}};
  for (int channels = 1; channels <= 4; ++channels) {
    double ridge = 0;
    for (int c = 0; c < channels; ++c) ridge += slopes[c][0] * slopes[c][0] + slopes[c][1] * slopes[c][1];
    const Target target(
        testing::drawn(40, 30, channels,
                       [&](double x, double y, int c) { return 60 + slopes[c][0] * x + slopes[c][1] * y; }),
        random_weights(40 * 30, kTargetSeed));
    Triangles triangles(40, 30, kTargetSeed + 2);
    for (int i = 0; i < 40; ++i) {
      const double error = target.error(triangles.next());
      EXPECT_GE(error, 0);
      // With the slopes of the picture itself the pixels have no error, and the ridge has this much.
      EXPECT_LE(error, ridge + 1e-6);
    }
  }
}

TEST(Target, PixelsWithoutWeightHaveNoSay) {
  image::Image image = test::random_picture(20, 20, 3, 5);
  const std::vector<float> weights = random_weights(400, kTargetSeed);
  const Target target(image, weights);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) image.samples[3 * i + 1] = 1000;
  }
  const Target other(image, weights);
  Triangles triangles(20, 20, kTargetSeed);
  for (int i = 0; i < 20; ++i) {
    const Triangle t = triangles.next();
    EXPECT_EQ(target.error(t), other.error(t));
  }
}

TEST(Target, TrianglesWithoutPixelsHaveNoError) {
  const Target target(test::random_picture(20, 20, 3, 5), {});
  const Triangle between{Vec2{3.6, 3.6}, Vec2{4.4, 3.6}, Vec2{4, 4.4}};
  EXPECT_EQ(target.fit(between).weight, 0);
  EXPECT_EQ(target.error(between), 0);
  const Triangle outside{Vec2{30, 3}, Vec2{40, 3}, Vec2{40, 8}};
  EXPECT_EQ(target.error(outside), 0);
  EXPECT_EQ(Target(test::random_picture(20, 20, 3, 5), std::vector<float>(400, 0.0F))
                .error({Vec2{0, 0}, Vec2{20, 0}, Vec2{0, 20}}),
            0);
}

TEST(Target, ColourInterpolatesThePicture) {
  const image::Image image = test::random_picture(7, 5, 2, 5);
  const Target target(image, {});
  const auto at = [&](int x, int y, int c) { return static_cast<double>(image.at(x, y, c)); };
  for (int c = 0; c < 2; ++c) {
    const auto colour = [&](Vec2 u) { return target.colour(u, 2)[static_cast<std::size_t>(c)]; };
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 7; ++x) {
        EXPECT_NEAR(colour(centre(x, y)), at(x, y, c), 1e-12);
        if (x == 6 || y == 4) continue;
        EXPECT_NEAR(colour(centre(x, y) + Vec2{0.25, 0.5}),
                    0.375 * (at(x, y, c) + at(x, y + 1, c)) + 0.125 * (at(x + 1, y, c) + at(x + 1, y + 1, c)),
                    1e-12);
      }
    }
    EXPECT_NEAR(colour({0, 5}), at(0, 4, c), 1e-12)
        << "beyond the outermost centres the picture stays as it is";
  }
}

TEST(Target, SquaredErrorIsThatOfTheFit) {
  LinearFit fit;
  fit.centre = {2, 3};
  fit.value = {10, 20};
  fit.gradient = {Vec2{1, -2}, Vec2{0.5, 3}};
  // At (4, 2) the fit is 10 + 2 + 2 and 20 + 1 - 3.
  EXPECT_NEAR(Target::squared_error(fit, {4, 2}, {15, 22, 1000, 1000}, 2), 1 + 16, 1e-12);
}

TEST(Target, ChangesToAnotherPictureAsIfMadeAnew) {
  Triangles triangles(30, 20, kTargetSeed);
  for (const bool weighted : {false, true}) {
    const std::vector<float> weights = weighted ? random_weights(600, kTargetSeed) : std::vector<float>{};
    const image::Image before = test::random_picture(30, 20, 3, 1);
    image::Image now = before;
    for (int y = 5; y < 9; ++y) std::ranges::fill(now.row(y), static_cast<float>(y));
    Target target(before, weights);
    target.change_to(now);
    const Target anew(now, weights);
    EXPECT_EQ(target.image().samples, now.samples);
    for (int n = 0; n < 200; ++n) {
      const Triangle t = triangles.next();
      ASSERT_EQ(target.error(t), anew.error(t));
      ASSERT_EQ(target.moments(t).c, anew.moments(t).c);
    }
  }
  Target target(test::random_picture(30, 20, 3, 1), {});
  EXPECT_THROW(target.change_to(test::random_picture(30, 21, 3, 1)), Error);
  EXPECT_THROW(target.change_to(test::random_picture(30, 20, 1, 1)), Error);
}

TEST(Target, RefusesWeightsOfAnotherSize) {
  EXPECT_THROW(Target(test::random_picture(4, 4, 1, 1), std::vector<float>(15)), Error);
}

}  // namespace
}  // namespace knotreel::knots
