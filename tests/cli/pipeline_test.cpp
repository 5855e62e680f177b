// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/metrics.h"
#include "knotreel/image/read_image.h"
#include "program.h"

namespace knotreel {
namespace {

using nlohmann::json;
using test::expect_success;
using test::read_text;
using test::Sample;

class CliChannels : public testing::TestWithParam<int> {};

TEST_P(CliChannels, VectorizeThenRenderIsCloseToThePicture) {
  const Sample sample(GetParam());
  expect_success(test::knotreel({"render", sample.document, "-o", sample.path("out.png")}));
  const image::Image before = image::read_image(sample.picture);
  const image::Image after = image::read_image(sample.path("out.png"));
  ASSERT_EQ(after.channels, GetParam());
  EXPECT_GT(image::compare_images(before, after).psnr, 30);
}

INSTANTIATE_TEST_SUITE_P(GreyToRgba, CliChannels, testing::Values(1, 2, 3, 4));

TEST(CliVectorize, ReadsStandardInput) {
  const Sample sample;
  expect_success(test::knotreel({"vectorize", "-", "-o", sample.path("stdin.tcb")},
                                {.input = read_text(sample.picture)}));
  EXPECT_EQ(read_text(sample.path("stdin.tcb")), read_text(sample.document));
}

TEST(CliRender, SizeScaleAndCropSayTheSizeOfTheOutput) {
  const Sample sample;  // 64 x 40
  const auto size = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"render", sample.document, "-o", sample.path("o.png")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    expect_success(test::knotreel(arguments));
    const image::Image image = image::read_image(sample.path("o.png"));
    return std::pair(image.width, image.height);
  };
  EXPECT_EQ(size({}), std::pair(64, 40));
  EXPECT_EQ(size({"--scale", "2.5"}), std::pair(160, 100));
  EXPECT_EQ(size({"--scale", "0.001"}), std::pair(1, 1));
  EXPECT_EQ(size({"--size", "100x30"}), std::pair(100, 30));
  EXPECT_EQ(size({"--scale", "4", "--crop", "10,20,30,7"}), std::pair(30, 7));
}

TEST(CliRender, ACropIsAPartOfTheWhole) {
  const Sample sample;
  expect_success(test::knotreel({"render", sample.document, "-o", sample.path("w.png"), "--scale", "4"}));
  expect_success(test::knotreel(
      {"render", sample.document, "-o", sample.path("c.png"), "--scale", "4", "--crop", "33,17,50,41"}));
  const image::Image whole = image::read_image(sample.path("w.png"));
  const image::Image crop = image::read_image(sample.path("c.png"));
  double largest = 0;
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 50; ++x) {
      for (int c = 0; c < 3; ++c) {
        largest = std::max(largest, std::abs(double{whole.at(x + 33, y + 17, c)} - double{crop.at(x, y, c)}));
      }
    }
  }
  EXPECT_LE(largest, 1);
}

TEST(CliRender, IsTheSameForEveryThreadCount) {
  const Sample sample;
  std::string first;
  for (const std::string threads : {"1", "2", "7"}) {
    const auto result = test::knotreel({"render", sample.document, "-o", "-", "--format", "ppm", "--size",
                                        "1500x900", "--threads", threads});
    expect_success(result);
    if (first.empty()) first = result.out;
    EXPECT_TRUE(result.out == first) << threads;
  }
}

TEST(CliRender, DepthsAgree) {
  const Sample sample;
  const auto render = [&](const std::string& name, const std::string& depth) {
    expect_success(test::knotreel({"render", sample.document, "-o", sample.path(name), "--depth", depth}));
    return image::read_image(sample.path(name));
  };
  const image::Image floats = render("f.pfm", "float");
  EXPECT_LE(test::largest_difference(floats, render("a.png", "8")), 0.5001);
  EXPECT_LE(test::largest_difference(floats, render("b.png", "16")), 0.51 / 257);
  EXPECT_LE(test::largest_difference(floats, render("c.tiff", "float")), 1e-4);
}

TEST(CliRender, APfmHasFloatsWithoutBeingTold) {
  const Sample sample;
  expect_success(test::knotreel({"render", sample.document, "-o", sample.path("a.pfm")}));
  expect_success(test::knotreel({"render", sample.document, "-o", sample.path("b.pfm"), "--depth", "float"}));
  expect_success(test::knotreel({"render", sample.document, "-o", sample.path("c"), "--format", "pfm"}));
  EXPECT_TRUE(read_text(sample.path("a.pfm")) == read_text(sample.path("b.pfm")));
  EXPECT_TRUE(read_text(sample.path("a.pfm")) == read_text(sample.path("c")));
  expect_failure(test::knotreel({"render", sample.document, "-o", sample.path("d.pfm"), "--depth", "8"}), 2);
}

TEST(CliRender, PgmIsGreyAndPpmIsNot) {
  const Sample grey(1);
  const Sample colour(3);
  const auto start = [&](const Sample& sample, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", sample.document};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = test::knotreel(arguments);
    expect_success(result);
    return (result.out.empty() ? read_text(more[1]) : result.out).substr(0, 2);
  };
  EXPECT_EQ(start(grey, {"-o", grey.path("a.ppm")}), "P6");
  EXPECT_EQ(start(grey, {"-o", grey.path("a.pgm")}), "P5");
  EXPECT_EQ(start(grey, {"-o", "-", "-f", "ppm"}), "P6");
  EXPECT_EQ(start(grey, {"-o", "-", "-f", "pnm"}), "P5");
  EXPECT_EQ(start(colour, {"-o", "-", "-f", "pnm"}), "P6");
  expect_failure(test::knotreel({"render", colour.document, "-o", colour.path("a.pgm")}), 2);
  expect_failure(test::knotreel({"render", colour.document, "-o", "-", "-f", "pgm"}), 2);
  const auto numbered = test::knotreel({"render", grey.document, "-o", grey.path("n_%d.ppm")});
  EXPECT_EQ(numbered.exit_code, 0) << numbered.err;
  EXPECT_TRUE(read_text(grey.path("n_1.ppm")).starts_with("P6"));
  expect_failure(test::knotreel({"render", colour.document, "-o", colour.path("n_%d.pgm")}), 2);
}

TEST(CliRender, StandardOutputHoldsTheSamePicture) {
  const Sample sample;
  expect_success(test::knotreel({"render", sample.document, "-o", sample.path("file.png")}));
  const auto result = test::knotreel({"render", sample.document, "-o", "-"});
  expect_success(result);
  EXPECT_EQ(result.out, read_text(sample.path("file.png")));
}

TEST(CliRender, DocumentsGoThroughPipes) {
  const Sample sample;
  const auto document = test::knotreel({"vectorize", "-", "-o", "-"}, {.input = read_text(sample.picture)});
  expect_success(document);
  EXPECT_EQ(document.out, read_text(sample.document));
  const auto piped = test::knotreel({"render", "-", "-o", "-"}, {.input = document.out});
  const auto direct = test::knotreel({"render", sample.document, "-o", "-"});
  expect_success(piped);
  EXPECT_EQ(piped.out, direct.out);
}

TEST(CliRender, MemoryDoesNotGrowWithTheOutput) {
  const Sample sample;
  const auto peak = [&](const std::string& size) {
    const auto result =
        test::knotreel({"render", sample.document, "-o", "/dev/null", "--format", "ppm", "--size", size});
    expect_success(result);
    return double(result.peak_memory_bytes);
  };
  // As floats, the larger one is 300 MB; both hold two bands of 12 MB.
  EXPECT_LT(peak("5000x5000") - peak("1500x1500"), 16e6);
}

/// A picture of 40x40 whose alpha is a half, and whose first channel 200, as a document.
std::string half_clear_document(const test::TempDir& dir, std::size_t channels) {
  image::Image clear = image::make_image(40, 40, static_cast<int>(channels));
  for (std::size_t i = 0; i < clear.samples.size(); i += channels) {
    clear.samples[i] = 200;
    clear.samples[i + channels - 1] = 127.5F;
  }
  std::string document = (dir / "d.tcb").string();
  image::write_image(dir / "clear.png", clear);
  expect_success(test::knotreel({"vectorize", (dir / "clear.png").string(), "-o", document}));
  return document;
}

TEST(CliRender, ABackgroundReplacesTheAlpha) {
  const test::TempDir dir;
  const std::string document = half_clear_document(dir, 4);
  const std::string output = (dir / "o.png").string();
  expect_success(test::knotreel({"render", document, "-o", output, "--background", "#0064ff"}));
  const image::Image image = image::read_image(output);
  ASSERT_EQ(image.channels, 3);
  EXPECT_NEAR(image.at(20, 20, 0), 100, 2);
  EXPECT_NEAR(image.at(20, 20, 1), 50, 2);
  EXPECT_NEAR(image.at(20, 20, 2), 127, 2);
}

TEST(CliRender, ABackgroundOfAColourStaysOneBehindGrey) {
  const test::TempDir dir;
  const std::string document = half_clear_document(dir, 2);
  const auto channels_and_corner = [&](const std::string& name, const std::string& colour) {
    const std::string output = (dir / name).string();
    const auto result = test::knotreel({"render", document, "-o", output, "--background", colour, "-q"});
    expect_success(result);
    const std::string drawn = name == "n_%d.png" ? (dir / "n_1.png").string() : output;
    const image::Image image = image::read_image(drawn);
    return std::pair(image.channels, image.row(20).subspan(0, std::size_t(image.channels)).back());
  };
  for (const std::string name : {"o.png", "n_%d.png"}) {
    const auto [channels, last] = channels_and_corner(name, "#ff0000");
    EXPECT_EQ(channels, 3) << name;
    EXPECT_NEAR(last, 100, 2) << name;
    EXPECT_EQ(channels_and_corner(name, "white").first, 1) << name;
  }
}

TEST(CliCompare, JsonHoldsTheFiguresOfTheLibrary) {
  const test::TempDir dir;
  const image::Image a = test::random_8bit_picture(30, 20, 3, 1);
  const image::Image b = test::random_8bit_picture(30, 20, 3, 2);
  image::write_image(dir / "a.png", a);
  image::write_image(dir / "b.png", b);
  const auto result =
      test::knotreel({"compare", (dir / "a.png").string(), (dir / "b.png").string(), "--json"});
  expect_success(result);
  const json figures = json::parse(result.out);
  const image::ImageMetrics expected = image::compare_images(a, b);
  EXPECT_DOUBLE_EQ(figures["mec"], expected.mec);
  EXPECT_DOUBLE_EQ(figures["rmse"], expected.rmse);
  EXPECT_DOUBLE_EQ(figures["psnr"], expected.psnr);
  EXPECT_DOUBLE_EQ(figures["ssim"], expected.ssim);
  const auto same = test::knotreel({"compare", (dir / "a.png").string(), (dir / "a.png").string(), "--json"});
  EXPECT_TRUE(json::parse(same.out)["psnr"].is_null());
}

TEST(CliInfo, TellsAboutDocumentsAndPictures) {
  const Sample sample;
  const auto document = test::knotreel({"info", sample.document, "--json"});
  const auto piped = test::knotreel({"info", "-", "--json"}, {.input = test::read_text(sample.document)});
  EXPECT_EQ(piped.out, document.out) << piped.err;
  expect_success(document);
  const json info = json::parse(document.out);
  EXPECT_EQ(info["kind"], "document");
  EXPECT_EQ(info["width"], 64);
  EXPECT_EQ(info["height"], 40);
  EXPECT_EQ(info["channels"], 3);
  EXPECT_EQ(info["degree"], 2);
  EXPECT_EQ(info["complete"], true);
  EXPECT_EQ(info["frames"].size(), 1u);
  EXPECT_EQ(info["file_bytes"], std::filesystem::file_size(sample.document));
  EXPECT_GT(info["control_points"], 0);

  const auto picture = test::knotreel({"info", sample.picture, "--json"});
  expect_success(picture);
  EXPECT_EQ(json::parse(picture.out)["format"], "PNG");
  expect_success(test::knotreel({"info", sample.document}));
  expect_success(test::knotreel({"info", sample.picture}));
}

TEST(CliDump, IsJson) {
  const Sample sample;
  const auto result = test::knotreel({"dump", sample.document, "--frame", "0"});
  expect_success(result);
  const json frame = json::parse(result.out);
  EXPECT_EQ(frame["degree"], 2);
  EXPECT_EQ(frame["width"], 64);
  expect_success(test::knotreel({"dump", sample.document, "-o", sample.path("dump.json")}));
  EXPECT_EQ(read_text(sample.path("dump.json")), result.out);
}

}  // namespace
}  // namespace knotreel
