// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdlib>

#include "export_models.h"
#include "knotreel/image/write_image.h"
#include "viewer.h"

/// The promise of the exports: other programs draw what our own renderer draws. The bounds are measured ones
/// plus a margin (docs/export.md has the figures). KNOTREEL_EXPORT_PICTURES=FOLDER keeps the pictures.
namespace knotreel::exporting {
namespace {

using namespace knotreel::testing;

void keep(const std::string& name, const image::Image& picture) {
  if (const char* folder = std::getenv("KNOTREEL_EXPORT_PICTURES")) {
    image::write_image(std::filesystem::path(folder) / (name + ".png"), picture);
  }
}

struct Bounds {
  double mean_off;
  double max_off;
  double mean_at;
  double max_at;
};

void expect_alike(const std::string& name, const document::FrameModel& model, int scale, Viewer viewer,
                  const Bounds& bounds) {
  SCOPED_TRACE(name + " at " + std::to_string(scale) + " by " + viewer_name(viewer));
  const image::Image ours = drawn_by_us(model, scale);
  const image::Image theirs = drawn_by(viewer, model, scale);
  const std::string file = name + "-" + std::to_string(scale) + "-";
  keep(file + "ours", ours);
  keep(file + viewer_name(viewer), theirs);
  ASSERT_EQ(theirs.width, ours.width);
  ASSERT_EQ(theirs.height, ours.height);
  const Differences d = compare(model, scale, theirs, ours);
  std::printf("%-28s %d %-8s off: mean %.2f max %.0f  at: mean %.2f max %.0f\n", name.c_str(), scale,
              viewer_name(viewer).c_str(), d.mean_off, d.max_off, d.mean_at, d.max_at);
  EXPECT_LE(d.mean_off, bounds.mean_off);
  EXPECT_LE(d.max_off, bounds.max_off);
  EXPECT_LE(d.mean_at, bounds.mean_at);
  EXPECT_LE(d.max_at, bounds.max_at);
}

// Off the features, what an SVG leaves away because nobody would see it at the size of the picture shows as a
// line at four times that.
constexpr Bounds kBounds{2.2, 20, 5, 40};
constexpr Bounds kSvgBounds{1.3, 40, 5, 45};

const Bounds& bounds_of(Viewer viewer) {
  return viewer == Viewer::kLibrsvg ? kSvgBounds : kBounds;
}

class Viewers : public ::testing::TestWithParam<Viewer> {};

TEST_P(Viewers, DrawFeaturesAsWeDo) {
  for (const char* name : {"free-knots", "two-tips", "bend", "three-fold-junction", "closed-loop",
                           "ends-on-border", "border-to-border-no-knots", "tip-inside-loop"}) {
    const document::FrameModel model = picture_like_model(corpus_case(name).mesh, 2, 3, 2, 7);
    for (const int scale : {1, 4}) expect_alike(name, model, scale, GetParam(), bounds_of(GetParam()));
  }
}

TEST_P(Viewers, DrawEveryDegree) {
  for (const int degree : {1, 3}) {
    const document::FrameModel model =
        picture_like_model(corpus_case("loop-with-tail").mesh, degree, 3, 2, 7);
    expect_alike("degree-" + std::to_string(degree), model, 4, GetParam(), bounds_of(GetParam()));
  }
}

TEST_P(Viewers, DrawGreyAndAlpha) {
  for (const int channels : {1, 2, 4}) {
    const document::FrameModel model = picture_like_model(corpus_case("closed-loop").mesh, 2, channels, 2, 7);
    expect_alike("channels-" + std::to_string(channels), model, 4, GetParam(), bounds_of(GetParam()));
  }
}

/// What a viewer draws turned is what it draws, turned.
TEST_P(Viewers, TurnPagesAsTold) {
  const document::FrameModel model = picture_like_model(corpus_case("three-fold-junction").mesh, 2, 4, 2, 7);
  const image::Image upright = drawn_by(GetParam(), model, 1);
  for (const Turn turn :
       {Turn{0, 1, -1, 0}, Turn{-1, 0, 0, -1}, Turn{0, -1, 1, 0}, Turn{-1, 0, 0, 1}, Turn{0, 1, 1, 0}}) {
    ExportOptions options;
    options.turn = turn;
    const image::Image page = drawn_by(GetParam(), model, 1, options);
    ASSERT_EQ(page.width, turn.swaps_sides() ? upright.height : upright.width);
    ASSERT_EQ(page.height, turn.swaps_sides() ? upright.width : upright.height);
    const Vec2 origin = turn.origin(page.width, page.height);
    double sum = 0;
    for (int y = 0; y < upright.height; ++y) {
      for (int x = 0; x < upright.width; ++x) {
        const double at_x = origin.x + (x + 0.5) * turn.right_x + (y + 0.5) * turn.down_x;
        const double at_y = origin.y + (x + 0.5) * turn.right_y + (y + 0.5) * turn.down_y;
        for (int c = 0; c < upright.colour_channels(); ++c)
          sum += std::abs(double(page.at(int(at_x), int(at_y), c) - upright.at(x, y, c)));
      }
    }
    EXPECT_LE(sum / double(upright.samples.size()), 1.0) << turn.right_x << turn.right_y;
  }
}

INSTANTIATE_TEST_SUITE_P(Programs, Viewers,
                         ::testing::Values(Viewer::kPoppler, Viewer::kMupdf, Viewer::kLibrsvg),
                         [](const auto& viewer) { return viewer_name(viewer.param); });

TEST(Qpdf, FindsNothingToComplainAbout) {
  for (const int channels : {1, 2, 3, 4}) {
    const test::TempDir dir;
    OutputFile file(dir / "x.pdf");
    write_pdf(picture_like_model(corpus_case("bend").mesh, 2, channels, 1, 7), {}, file);
    file.commit();
    const test::ProcessResult result = test::run({"/usr/bin/qpdf", "--check", (dir / "x.pdf").string()});
    EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  }
}

}  // namespace
}  // namespace knotreel::exporting
