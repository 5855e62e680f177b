// SPDX-License-Identifier: GPL-3.0-or-later
#include "program.h"

namespace knotreel {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::read_text;
using test::TempDir;

/// A small picture with features, and vectorize on it.
class CliVectorizeOptions : public testing::Test {
 protected:
  CliVectorizeOptions() { image::write_image(picture_, test::sharp_picture(48, 32, 3)); }

  test::ProcessResult vectorize(std::vector<std::string> options) const {
    options.insert(options.begin(), {"vectorize", picture_, "-o", document_});
    return test::knotreel(options);
  }

  /// All that --stats tells of a run with these options.
  json stats(std::vector<std::string> options) const {
    options.insert(options.end(), {"--stats", "-"});
    const auto result = vectorize(options);
    expect_success(result);
    return json::parse(result.out);
  }

  TempDir dir_;
  std::string picture_ = (dir_ / "in.png").string();
  std::string document_ = (dir_ / "out.tcb").string();
};

TEST_F(CliVectorizeOptions, WrongValuesAreExit2AndLeaveNothing) {
  const std::vector<std::vector<std::string>> cases{
      {"--preset", "best"},
      {"--mec", "-1"},
      {"--mec", "nan"},
      {"--meg", "-0.1"},
      {"--meg", "inf"},
      {"--rounds", "0"},
      {"--rounds", "1.5"},
      {"--degree", "4"},
      {"--max-control-points", "0"},
      {"--max-control-points", "-5"},
      {"--max-control-points", "0%"},
      {"--max-control-points", "101%"},
      {"--max-control-points", "5 %"},
      {"--min-feature-length", "-1"},
      {"--edge-threshold", "0"},
      {"--edge-threshold", "NaN"},
      {"--max-blur", "-1"},
      {"--descent-steps", "1001"},
      {"--seed", "-1"},
      {"--no-features=perhaps"},
      {"--control-points", "2%"},
      {"--mec"},
  };
  for (const auto& options : cases) {
    SCOPED_TRACE(testing::PrintToString(options));
    expect_failure(vectorize(options), 2);
  }
  expect_failure(test::knotreel({"vectorize", picture_, "-o", "-", "--stats", "-"}), 2);
  EXPECT_EQ(dir_.entries(), 1u) << "no output may be left";
}

TEST_F(CliVectorizeOptions, WhatIsAboutFeaturesDoesNotGoWithNone) {
  const std::vector<std::vector<std::string>> cases{{"--edge-threshold", "20"},
                                                    {"--min-feature-length", "20"},
                                                    {"--max-blur", "1"},
                                                    {"--fine-grid", "all"},
                                                    {"--meg", "0.5"}};
  for (std::vector<std::string> options : cases) {
    options.emplace_back("--no-features");
    SCOPED_TRACE(testing::PrintToString(options));
    const auto result = vectorize(options);
    expect_failure(result, 2);
    EXPECT_NE(result.err.find(options[0] + " is of no use with --no-features"), std::string::npos)
        << result.err;
  }
}

TEST_F(CliVectorizeOptions, EveryOptionReachesThePipeline) {
  struct Case {
    std::vector<std::string> option;
    json::json_pointer place;
    json value;
  };
  const auto at = [](const char* pointer) { return json::json_pointer(pointer); };
  const std::vector<Case> cases{
      {{"--mec", "0.5"}, at("/mec"), 0.5},
      {{"--block-error", "2.5"}, at("/block_error"), 2.5},
      {{"--meg", "0"}, at("/meg"), 0.0},
      {{"--rounds", "2"}, at("/rounds"), 2},
      {{"--degree", "1"}, at("/degree"), 1},
      {{"--degree", "3"}, at("/degree"), 3},
      {{"--max-control-points", "99"}, at("/max_control_points"), 99},
      {{"--max-control-points", "25%"}, at("/max_control_points"), 384},
      {{"--min-feature-length", "30"}, at("/detect/min_length"), 30.0},
      {{"--edge-threshold", "7.5"}, at("/detect/edge_threshold"), 7.5},
      {{"--max-blur", "1.5"}, at("/detect/max_blur"), 1.5},
      {{"--no-features"}, at("/features"), false},
      {{"--no-fairing"}, at("/fairing"), false},
      {{"--no-corner-detection"}, at("/corner_detection"), false},
      {{"--fine-grid", "none"}, at("/fine_grid"), "none"},
      {{"--fine-grid", "all"}, at("/fine_grid"), "all"},
      {{"--preset", "fast"}, at("/fine_grid"), "none"},
      {{"--no-colour-correction"}, at("/colour_correction"), false},
      {{"--no-knot-optimisation"}, at("/optimise/positions"), false},
      {{"--no-knot-optimisation"}, at("/optimise/connectivity"), false},
      {{"--no-picture-links"}, at("/picture_links"), false},
      {{"--descent-steps", "1"}, at("/descent_steps"), 1},
      {{"--no-smooth-corners"}, at("/smooth_corners"), false},
      {{"--seed", "9"}, at("/seed"), 9},
  };
  const json usual = stats({})["options"];
  for (const Case& c : cases) {
    SCOPED_TRACE(testing::PrintToString(c.option));
    EXPECT_NE(usual[c.place], c.value);
    EXPECT_EQ(stats(c.option)["options"][c.place], c.value);
  }
}

TEST_F(CliVectorizeOptions, WhatIsGivenHoldsForDrawingsToo) {
  const auto value = [&](const char* member, const std::vector<std::string>& options) {
    return stats(options)["options"][member].get<double>();
  };
  EXPECT_GT(value("drawn_blur", {"--preset", "fine"}), 0);
  EXPECT_EQ(value("drawn_blur", {"--preset", "fine", "--max-blur", "1.5"}), 0);
  EXPECT_GT(value("drawn_threshold", {}), 0);
  EXPECT_EQ(value("drawn_threshold", {"--edge-threshold", "9"}), 0);
}

TEST_F(CliVectorizeOptions, HelpTellsTheDefaultsThatHold) {
  const std::string help = test::knotreel({"vectorize", "--help"}).out;
  const json usual = stats({})["options"];
  const auto told = [&](const std::string& option) {
    const std::size_t start = help.find("default ", help.find("\n  " + option + " ")) + 8;
    return std::stod(help.substr(start));
  };
  for (const char* option : {"mec", "block-error", "meg", "rounds", "descent-steps", "degree"}) {
    std::string name = option;
    std::replace(name.begin(), name.end(), '-', '_');
    EXPECT_EQ(told("--" + std::string(option)), usual[name].get<double>()) << option;
  }
  EXPECT_EQ(told("--edge-threshold"), usual["detect"]["edge_threshold"].get<double>());
  EXPECT_EQ(told("--min-feature-length"), usual["detect"]["min_length"].get<double>());
  EXPECT_EQ(told("--max-blur"), usual["detect"]["max_blur"].get<double>());
}

TEST_F(CliVectorizeOptions, TheEdgeThresholdTakesTheAnchorsAlong) {
  const json usual = stats({})["options"]["detect"];
  const json twice = stats({"--edge-threshold", std::to_string(2 * usual["edge_threshold"].get<double>())});
  EXPECT_DOUBLE_EQ(twice["options"]["detect"]["anchor_threshold"],
                   2 * usual["anchor_threshold"].get<double>());
}

TEST_F(CliVectorizeOptions, APresetComesFirstWhereverItStands) {
  const json fast = stats({"--preset", "fast"});
  EXPECT_EQ(fast["preset"], "fast");
  EXPECT_EQ(fast["options"]["descent_steps"], 0);
  EXPECT_GT(stats({"--preset", "fine"})["options"]["descent_steps"], 10);
  EXPECT_EQ(stats({"--preset", "balanced"})["options"], stats({})["options"]);
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--preset", "fast", "--descent-steps", "2"},
        std::vector<std::string>{"--descent-steps", "2", "--preset", "fast"}}) {
    const json both = stats(options)["options"];
    EXPECT_EQ(both["descent_steps"], 2);
    EXPECT_EQ(both["rounds"], fast["options"]["rounds"]);
  }
}

TEST_F(CliVectorizeOptions, FeaturesCanBeLeftOut) {
  EXPECT_GT(stats({})["features"]["chains"], 0);
  EXPECT_EQ(stats({"--no-features"})["features"]["chains"], 0);
  // With a threshold at which none links two others; those stay.
  EXPECT_GT(stats({"--edge-threshold", "8"})["features"]["chains"], 0);
  EXPECT_EQ(stats({"--edge-threshold", "8", "--min-feature-length", "1000"})["features"]["chains"], 0);
  EXPECT_EQ(stats({"--edge-threshold", "200"})["features"]["chains"], 0);
}

TEST_F(CliVectorizeOptions, TheSameFileForEveryThreadCount) {
  std::string first;
  for (const std::string threads : {"1", "2", "5"}) {
    expect_success(vectorize({"--threads", threads}));
    if (first.empty()) first = read_text(document_);
    EXPECT_TRUE(read_text(document_) == first) << threads;
  }
  expect_success(vectorize({"--seed", "77"}));
  EXPECT_TRUE(read_text(document_) == first) << "no random numbers are drawn";
}

TEST_F(CliVectorizeOptions, MoreControlPointsBringThePictureCloser) {
  const json few = stats({"--max-control-points", "120", "--mec", "0"});
  const json many = stats({"--max-control-points", "600", "--mec", "0"});
  EXPECT_GT(many["control_points"], few["control_points"].get<int>() + 100);
  EXPECT_GT(test::json_psnr(many), test::json_psnr(few) + 1);
}

}  // namespace
}  // namespace knotreel
