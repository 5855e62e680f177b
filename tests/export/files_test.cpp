// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <set>

#include "export/svg_text.h"
#include "export_models.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/export/pdf.h"
#include "knotreel/export/svg.h"
#include "support/temp_dir.h"

namespace knotreel::exporting {
namespace {

using namespace knotreel::testing;
using test::read_text;
using test::TempDir;

using Write = ExportReport (*)(const document::FrameModel&, const ExportOptions&, OutputFile&);

std::string exported(Write write, const document::FrameModel& model, const ExportOptions& options = {}) {
  const TempDir dir;
  OutputFile file(dir / "x");
  write(model, options, file);
  file.commit();
  return read_text(dir / "x");
}

document::FrameModel sample(int channels) {
  return picture_like_model(corpus_case("loop-with-tail").mesh, 2, channels, 1, 5);
}

TEST(Pdf, EveryOffsetOfTheTableLeadsToItsObject) {
  for (const int channels : {1, 2, 3, 4}) {
    const std::string pdf = exported(write_pdf, sample(channels));
    ASSERT_TRUE(pdf.starts_with("%PDF-1.4\n"));
    ASSERT_TRUE(pdf.ends_with("%%EOF\n"));
    const std::size_t start = pdf.rfind("startxref\n");
    const std::size_t table = std::stoul(pdf.substr(start + 10));
    ASSERT_EQ(pdf.compare(table, 7, "xref\n0 "), 0);
    const std::size_t count = std::stoul(pdf.substr(table + 7));
    const std::size_t first = pdf.find('\n', table + 5) + 1;
    for (std::size_t i = 1; i < count; ++i) {
      const std::string entry = pdf.substr(first + 20 * i, 20);
      EXPECT_EQ(entry.substr(10), " 00000 n \n");
      const std::string head = std::to_string(i) + " 0 obj\n";
      EXPECT_EQ(pdf.compare(std::stoul(entry), head.size(), head), 0) << entry;
    }
  }
}

TEST(Pdf, PageHasTheSizeOfThePictureTimesTheScale) {
  ExportOptions options;
  options.scale = 2.5;
  EXPECT_NE(exported(write_pdf, sample(3), options).find("/MediaBox[0 0 250 200]"), std::string::npos);
}

TEST(Pdf, PagesLargerThanProgramsHaveToTakeAreToldInLargerUnits) {
  ExportOptions options;
  options.scale = 144;  // 14400 points
  const std::string largest = exported(write_pdf, sample(3), options);
  EXPECT_TRUE(largest.starts_with("%PDF-1.4\n"));
  EXPECT_EQ(largest.find("/UserUnit"), std::string::npos);
  options.scale = 400;
  const std::string larger = exported(write_pdf, sample(3), options);
  EXPECT_TRUE(larger.starts_with("%PDF-1.6\n"));
  EXPECT_NE(larger.find("/MediaBox[0 0 10000 8000]/UserUnit 4"), std::string::npos);
}

TEST(Svg, TellsThatThereAreNoStrokes) {
  const std::string svg = exported(write_svg, sample(4));
  const std::size_t root = svg.find("<svg ");
  EXPECT_LT(svg.find(" stroke=\"none\"", root), svg.find('>', root));
}

/// All names that are used, in what order ever, are given once.
TEST(Svg, RefersToWhatItDefines) {
  for (const int channels : {1, 2, 3, 4}) {
    const std::string svg = exported(write_svg, sample(channels));
    std::multiset<std::string> given;
    const auto all = [&](const std::string& before, char end, auto visit) {
      for (std::size_t at = svg.find(before); at != std::string::npos; at = svg.find(before, at + 1)) {
        const std::size_t begin = at + before.size();
        visit(svg.substr(begin, svg.find(end, begin) - begin));
      }
    };
    all(" id=\"", '"', [&](const std::string& name) { given.insert(name); });
    std::size_t used = 0;
    const auto expect_given = [&](const std::string& name) {
      EXPECT_EQ(given.count(name), 1u) << name;
      ++used;
    };
    all("url(#", ')', expect_given);
    all("href=\"#", '"', expect_given);
    EXPECT_GT(used, 10u);
    EXPECT_EQ(svg.find("d=\"\""), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
  }
}

TEST(Svg, OneColourIsOnePath) {
  document::FrameModel model = sample(3);
  for (std::size_t i = 0; i < model.colour.size(); ++i) model.colour[i] = i % 3 == 0 ? 255 : 17;
  const std::string svg = exported(write_svg, model);
  EXPECT_LT(svg.size(), 600u);
  const std::size_t path = svg.find("<path ");
  EXPECT_NE(svg.find("fill=\"#f11\"", path), std::string::npos);
  EXPECT_EQ(svg.find("<path ", path + 1), std::string::npos);
  EXPECT_EQ(svg.find("Gradient"), std::string::npos);
}

TEST(Pdf, GreyStaysGreyAndAlphaIsASoftMask) {
  EXPECT_EQ(exported(write_pdf, sample(1)).find("DeviceRGB"), std::string::npos);
  EXPECT_NE(exported(write_pdf, sample(2)).find("/A<</Type/ExtGState/SMask"), std::string::npos);
  EXPECT_EQ(exported(write_pdf, sample(3)).find("/A<</Type/ExtGState/SMask"), std::string::npos);
}

TEST(Export, IsTheSameForEveryThreadCount) {
  const document::FrameModel model = sample(4);
  for (const Write write : {Write{write_pdf}, Write{write_svg}}) {
    const ThreadCap one(1);
    const std::string expected = exported(write, model);
    const ThreadCap three(3);
    EXPECT_EQ(exported(write, model), expected);
  }
}

/// Documents may come from anywhere: surfaces folded, collapsed or of any size, and colours far out of range.
TEST(Svg, OfAWildSurfaceIsAFileOrAMessage) {
  ExportOptions options;
  options.max_triangles = 20'000;
  for (const double reach : {0.0, 30.0, 1e4, 1e8, 1e12}) {
    for (const double level : {255.0, 1e4, 1e12}) {
      SCOPED_TRACE(std::to_string(reach) + " px, level " + std::to_string(level));
      document::FrameModel model = sample(3);
      std::mt19937 random(11);
      std::uniform_real_distribution<double> unit(-1, 1);
      for (Vec2& d : model.displacement) d = {reach * unit(random), reach * unit(random)};
      for (double& c : model.colour) c = level * unit(random);
      try {
        const std::string svg = exported(write_svg, model, options);
        EXPECT_EQ(svg.find("nan"), std::string::npos);
        EXPECT_EQ(svg.find("inf"), std::string::npos);
      } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::kInvalidArgument);
      }
    }
  }
}

/// From all of it in one point to the largest that a model may have.
TEST(Svg, OfASurfaceOfAnySizeHasNumbers) {
  for (const double size : {0.0, 1e-9, 1e-3, 1e4, 1e7, 1e9}) {
    SCOPED_TRACE(size);
    document::FrameModel model = blank_model(corpus_case("free-knots").mesh, 2, 3);
    const std::vector<Vec2> sites = model.space->geometry_greville();
    for (std::size_t g = 0; g < sites.size(); ++g) model.displacement[g] = size * sites[g] - sites[g];
    for (spline::FunctionIndex f = 0; f < model.space->function_count(); ++f) {
      for (std::size_t c = 0; c < 3; ++c) model.colour[3 * f + c] = 2 * model.space->greville(f).x;
    }
    const std::string svg = exported(write_svg, model);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    EXPECT_EQ(svg.find("<path ") != std::string::npos, size >= 1e-3);
  }
}

/// Faces that are large in the picture and small in the mesh are halved for their paints as often as their
/// size asks for.
TEST(Svg, HalvingForPaintsCountsTriangles) {
  document::FrameModel model = sample(3);
  const std::vector<Vec2> sites = model.space->geometry_greville();
  for (std::size_t g = 0; g < sites.size(); ++g) model.displacement[g] = 1e5 * sites[g];
  for (spline::FunctionIndex f = 0; f < model.space->function_count(); ++f) {
    const Vec2 g = model.space->greville(f);
    model.colour[3 * f] = 2.5 * g.x;
    model.colour[3 * f + 1] = 3 * g.y;
    model.colour[3 * f + 2] = g.x + g.y;
  }
  ExportOptions options;
  options.tessellation.colour_tolerance = 0.1;
  options.max_triangles = 10'000;
  std::size_t calls = 0;
  options.checkpoint = [&] { ++calls; };
  EXPECT_THROW(exported(write_svg, model, options), Error);
  EXPECT_GT(calls, 1u);
}

TEST(SvgText, PathsAreShortAndExact) {
  const Loop triangle{straight({0.5, 10}, {1, 10.25}), straight({1, 10.25}, {1, -0.5}),
                      straight({1, -0.5}, {0.5, 10})};
  EXPECT_EQ(path_data({triangle}), "M.5 10l.5.25v-10.75l-.5 10.5z");
  const Loop drop{{Vec2{0, 0}, Vec2{2, 0}, Vec2{3, 1}, Vec2{3, 3}}, straight({3, 3}, {0, 0})};
  EXPECT_EQ(path_data({drop}), "M0 0q3 0 3 3l-3-3z");
  const Loop bulge{{Vec2{0, 0}, Vec2{1, 0}, Vec2{3, 1}, Vec2{3, 3}}, straight({3, 3}, {0, 0})};
  EXPECT_EQ(path_data({bulge}), "M0 0c1 0 3 1 3 3l-3-3z");
}

TEST(SvgText, OutlinesWithoutAreaAreLeftAway) {
  const Loop line{straight({1, 2}, {3, 4}), straight({3, 4}, {1, 2})};
  const Loop point{straight({1, 2}, {1.001, 2}), straight({1.001, 2}, {1, 2})};
  EXPECT_EQ(path_data({line, point}), "");
}

/// Overshoots are cut off where they begin: a gradient whose ends alone were cut off would be grey between.
TEST(Svg, GradientsPastWhiteAreWhiteFromThereOn) {
  document::FrameModel model = blank_model(corpus_case("free-knots").mesh, 2, 1);
  for (spline::FunctionIndex f = 0; f < model.space->function_count(); ++f) {
    model.colour[f] = 5.1 * model.space->greville(f).x;  // white at 50 of 100 px
  }
  const std::string svg = exported(write_svg, model);
  const std::size_t gradient = svg.find("<linearGradient id=\"r");
  const std::string first = svg.substr(gradient, svg.find('\n', gradient) - gradient);
  const auto number = [&](const std::string& name) { return std::stod(first.substr(first.find(name) + 4)); };
  EXPECT_NEAR(std::min(number("x1=\""), number("x2=\"")), 0, 0.1) << first;
  EXPECT_NEAR(std::max(number("x1=\""), number("x2=\"")), 50, 1) << first;
  EXPECT_NE(first.find("#fff"), std::string::npos);
}

TEST(Export, RefusesMoreTrianglesThanAllowedAndLeavesNoFile) {
  ExportOptions options;
  options.max_triangles = 50;
  for (const Write write : {Write{write_pdf}, Write{write_svg}}) {
    const TempDir dir;
    {
      OutputFile file(dir / "x");
      EXPECT_THROW(write(sample(3), options, file), Error);
    }
    EXPECT_EQ(dir.entries(), 0u);
  }
}

TEST(Export, RefusesScalesOutOfRange) {
  for (const double scale : {0.0, -1.0, 1e4, std::nan("")}) {
    ExportOptions options;
    options.scale = scale;
    EXPECT_THROW(exported(write_pdf, sample(1), options), Error);
    EXPECT_THROW(exported(write_svg, sample(1), options), Error);
    EXPECT_THROW(check_options(options), Error);
  }
}

TEST(Export, OptionsCanBeCheckedBeforeThereIsAnythingToExport) {
  ExportOptions options;
  EXPECT_NO_THROW(check_options(options));
  options.tessellation.colour_tolerance = 0;
  EXPECT_THROW(check_options(options), Error);
}

TEST(Export, StopsWhenTheCheckpointThrows) {
  ExportOptions options;
  options.checkpoint = [] { throw Error(ErrorKind::kInterrupted, "stopped"); };
  EXPECT_THROW(exported(write_pdf, sample(3), options), Error);
  EXPECT_THROW(exported(write_svg, sample(3), options), Error);
}

TEST(Export, CoarserTolerancesGiveSmallerFiles) {
  ExportOptions coarse;
  coarse.tessellation.colour_tolerance = 16;
  coarse.tessellation.geometry_tolerance = 0.5;
  for (const Write write : {Write{write_pdf}, Write{write_svg}}) {
    EXPECT_LT(exported(write, sample(3), coarse).size(), exported(write, sample(3)).size());
  }
}

}  // namespace
}  // namespace knotreel::exporting
