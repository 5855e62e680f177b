// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>
#include <filesystem>

#include "knotreel/image/read_image.h"
#include "program.h"

namespace knotreel {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::read_text;
using test::TempDir;
namespace fs = std::filesystem;

struct SharpSample {
  TempDir dir;
  std::string picture = (dir / "in.png").string();
  std::string document = (dir / "out.tcb").string();
  std::string stats = (dir / "stats.json").string();
  std::string debug = (dir / "debug/pictures").string();

  explicit SharpSample(int width = 48, int height = 32, int channels = 3) {
    image::write_image(picture, test::sharp_picture(width, height, channels));
  }
  test::ProcessResult vectorize(std::vector<std::string> options) const {
    options.insert(options.begin(), {"vectorize", picture, "-o", document});
    return test::knotreel(options);
  }
};

void expect_keys(const json& object, const std::vector<std::string>& keys) {
  std::vector<std::string> present;
  for (const auto& [key, value] : object.items()) present.push_back(key);
  std::vector<std::string> wanted = keys;
  std::sort(wanted.begin(), wanted.end());
  EXPECT_EQ(present, wanted);
}

TEST(CliStats, HoldWhatTheDocumentationPromises) {
  const SharpSample sample;
  expect_success(sample.vectorize({"--stats", sample.stats}));
  const json stats = json::parse(read_text(sample.stats));
  expect_keys(stats, {"version",
                      "input",
                      "output",
                      "width",
                      "height",
                      "channels",
                      "preset",
                      "threads",
                      "options",
                      "features",
                      "rounds",
                      "knots",
                      "triangles",
                      "feature_segments",
                      "control_points",
                      "raw_accounting_bytes",
                      "edge_softness",
                      "file_bytes",
                      "mec",
                      "rmse",
                      "psnr",
                      "ssim",
                      "seconds"});
  expect_keys(stats["options"], {"degree",
                                 "mec",
                                 "block_error",
                                 "meg",
                                 "mixed_weight",
                                 "rounds",
                                 "max_control_points",
                                 "descent_steps",
                                 "seed",
                                 "first_share",
                                 "feature_share",
                                 "weak_share",
                                 "drawn_weak_share",
                                 "max_turning",
                                 "features",
                                 "fairing",
                                 "corner_detection",
                                 "colour_correction",
                                 "picture_links",
                                 "smooth_corners",
                                 "clear_curves",
                                 "clear_inside",
                                 "longest_edge",
                                 "fine_grid",
                                 "detect",
                                 "drawn_blur",
                                 "drawn_distance",
                                 "drawn_threshold",
                                 "fair",
                                 "corners",
                                 "correction",
                                 "parametrize",
                                 "segment_knot_spacing",
                                 "optimise",
                                 "colour",
                                 "geometry"});
  expect_keys(stats["features"], {"chains", "over_budget", "corners", "pixels", "polyline_vertices",
                                  "folds_left", "dropped", "fine_grid"});
  for (const json& round : stats["rounds"]) {
    expect_keys(round,
                {"name", "knots", "control_points", "mec", "meg", "psnr", "raw_bytes", "milliseconds"});
    for (const auto& [stage, ms] : round["milliseconds"].items()) EXPECT_GE(ms, 0.0) << stage;
  }
  expect_keys(stats["seconds"], {"decode", "vectorize", "write", "measure", "total"});
}

TEST(CliStats, AreConsistent) {
  const SharpSample sample;
  expect_success(sample.vectorize({"--stats", sample.stats}));
  const json stats = json::parse(read_text(sample.stats));
  EXPECT_EQ(stats["version"], KNOTREEL_VERSION);
  EXPECT_EQ(stats["file_bytes"], fs::file_size(sample.document));
  EXPECT_GT(stats["features"]["pixels"], 50);
  EXPECT_GT(stats["feature_segments"], 0);
  EXPECT_GE(stats["edge_softness"], 0.0);
  EXPECT_LE(stats["edge_softness"], 0.25);

  const json& rounds = stats["rounds"];
  ASSERT_GE(rounds.size(), 2u);
  EXPECT_EQ(rounds.front()["name"], "round 1");
  EXPECT_EQ(rounds.back()["name"], "final");
  EXPECT_EQ(rounds.back()["control_points"], stats["control_points"]);
  EXPECT_EQ(rounds.back()["knots"], stats["knots"]);
  EXPECT_EQ(rounds.back()["raw_bytes"], stats["raw_accounting_bytes"]);
  EXPECT_EQ(stats["raw_accounting_bytes"], 20 * stats["control_points"].get<int>() +
                                               8 * stats["knots"].get<int>() +
                                               6 * stats["triangles"].get<int>());
  double milliseconds = 0;
  for (const json& round : rounds) {
    for (const auto& [stage, ms] : round["milliseconds"].items()) milliseconds += ms.get<double>();
  }
  EXPECT_LE(milliseconds / 1000, stats["seconds"]["vectorize"].get<double>() + 1e-3);
  double seconds = 0;
  for (const auto& [stage, s] : stats["seconds"].items()) seconds += stage == "total" ? 0 : s.get<double>();
  EXPECT_NEAR(seconds, stats["seconds"]["total"], 1e-9);

  const auto compared = test::knotreel({"compare", sample.picture, sample.document, "--json"});
  expect_success(compared);
  const json figures = json::parse(compared.out);
  for (const char* figure : {"mec", "rmse", "psnr", "ssim"})
    EXPECT_EQ(stats[figure], figures[figure]) << figure;
  EXPECT_GT(test::json_psnr(stats), 28);
}

std::vector<std::string> names(const std::string& folder) {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder)) found.push_back(entry.path().filename().string());
  std::sort(found.begin(), found.end());
  return found;
}

TEST(CliDebugDir, HoldsAPictureOfEveryStage) {
  const SharpSample sample;
  const auto result = sample.vectorize({"--debug-dir", sample.debug, "--stats", "-"});
  expect_success(result);
  const json stats = json::parse(result.out);
  std::vector<std::string> wanted{"01-features.png", "02-faired.png", "03-corrected.png",
                                  "04-parametrization.png", "05-knots.png"};
  int number = 6;
  const auto add = [&](const std::string& name) {
    wanted.push_back((number < 10 ? "0" : "") + std::to_string(number) + "-" + name + ".png");
    ++number;
  };
  for (const json& round : stats["rounds"]) {
    std::string name = round["name"];
    std::replace(name.begin(), name.end(), ' ', '-');
    for (const char* kind : {"-mesh", "-fit", "-error"}) add(name + kind);
  }
  add("control-net");
  EXPECT_EQ(names(sample.debug), wanted);
  for (const std::string& name : wanted) {
    const image::Image picture = image::read_image(sample.debug + "/" + name);
    const bool fit = name.ends_with("-fit.png");
    // Of drawings as this one, what comes before the end is on pixels of half the size.
    const int width = name.find("final") == std::string::npos ? 96 : 48;
    EXPECT_TRUE(fit ? picture.width == width : picture.width > width) << name;
  }
  EXPECT_GT(stats["seconds"]["debug"], 0.0);
}

TEST(CliDebugDir, ChangesNothingInTheDocument) {
  const SharpSample sample(40, 30, 4);
  expect_success(sample.vectorize({}));
  const std::string plain = read_text(sample.document);
  expect_success(sample.vectorize({"--debug-dir", sample.debug}));
  EXPECT_EQ(read_text(sample.document), plain);
}

TEST(CliDebugDir, TakesPicturesOfAnySizeAndOptionsOfAnyKind) {
  const SharpSample tiny(1, 1, 1);
  expect_success(tiny.vectorize({"--debug-dir", tiny.debug}));
  EXPECT_TRUE(fs::exists(tiny.debug + "/05-knots.png"));
  const SharpSample sample(24, 40, 2);
  for (const std::string degree : {"1", "2", "3"}) {
    expect_success(sample.vectorize({"--debug-dir", sample.debug, "--degree", degree, "--preset", "fast"}));
  }
  const SharpSample smooth;
  expect_success(smooth.vectorize({"--debug-dir", smooth.debug, "--no-features"}));
  EXPECT_FALSE(fs::exists(smooth.debug + "/01-features.png")) << "there was no such stage";
}

TEST(CliDebugDir, ThatCannotBeMadeIsExit4) {
  const SharpSample sample;
  for (const std::string& folder : {sample.picture, sample.picture + "/below", std::string("/proc/debug")}) {
    expect_failure(sample.vectorize({"--debug-dir", folder}), 4);
  }
  expect_failure(sample.vectorize({"--stats", "/proc/stats.json"}), 4);
  EXPECT_EQ(sample.dir.entries(), 1u) << "no output may be left";
}

TEST(CliInterrupt, BetweenStagesOfVectorizingLeavesNoDocument) {
  const SharpSample sample(160, 120);
  fs::create_directories(sample.debug);
  for (const std::string stage : {"01-features", "05-knots", "07-round-1-fit"}) {
    for (const auto& entry : fs::directory_iterator(sample.debug)) fs::remove(entry.path());
    test::ProcessOptions process;
    process.signal_once = fs::path(sample.debug) / stage;
    process.signal = SIGINT;
    expect_failure(test::knotreel({"vectorize", sample.picture, "-o", sample.document, "--preset", "fine",
                                   "--debug-dir", sample.debug},
                                  process),
                   130);
    EXPECT_EQ(sample.dir.entries(), 2u) << stage;
  }
}

}  // namespace
}  // namespace knotreel
