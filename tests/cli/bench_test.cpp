// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <sstream>

#include "program.h"
#include "support/clips.h"

namespace knotreel {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::knotreel;
using test::read_text;

class CliBench : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  /// Of a tiny clip at one and two threads.
  json measured(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"bench",
                                       "static",
                                       "--size",
                                       "64x36",
                                       "--frames",
                                       "4",
                                       "--json",
                                       result_,
                                       "--preset",
                                       "fast",
                                       "--max-control-points",
                                       "200"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = knotreel(arguments);
    expect_success(result);
    output_ = result.out;
    return json::parse(read_text(result_));
  }

  test::TempDir dir_;
  std::string result_ = (dir_ / "r.json").string();
  std::string output_;
};

/// Lines of a comparison that tell of a figure.
std::vector<std::string> figure_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("  ")) lines.push_back(line);
  }
  return lines;
}

TEST_F(CliBench, TheResultHasAllFigures) {
  const json result = measured();
  EXPECT_EQ(result["version"], KNOTREEL_VERSION);
  for (const char* member : {"commit", "date"}) EXPECT_FALSE(result[member].get<std::string>().empty());
  for (const char* member : {"cpu", "cores", "memory_bytes"}) EXPECT_TRUE(result["machine"].contains(member));
  for (const char* member : {"name", "flags"}) EXPECT_TRUE(result["compiler"].contains(member));
  ASSERT_EQ(result["runs"].size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const json& run = result["runs"][i];
    EXPECT_EQ(run["clip"], "static");
    EXPECT_EQ(run["size"], "64x36");
    EXPECT_EQ(run["preset"], "fast");
    EXPECT_EQ(run["threads"], i + 1);
    EXPECT_EQ(run["frames"], 4);
    EXPECT_LE(run["control_points"], 200);
    for (const char* figure :
         {"fps", "passthrough_fps", "share_of_passthrough", "first_frame_seconds", "busy_cores",
          "peak_memory_bytes", "document_bytes_per_frame", "video_bytes_per_frame", "psnr", "ssim", "flicker",
          "warped_flicker", "speedup", "warm_speedup", "seconds", "start_and_end_seconds"}) {
      EXPECT_GT(run[figure], 0) << figure;
    }
    EXPECT_EQ(run["cold"]["frames"].get<int>() + run["warm"]["frames"].get<int>(), 4);
    EXPECT_GT(run["warm"]["fps"], 0);
    for (const char* stage : {"decode", "analyse", "model", "documents", "rasterize", "encode"}) {
      EXPECT_TRUE(run["cold"]["milliseconds"].contains(stage)) << stage;
      EXPECT_TRUE(run["warm"]["milliseconds"].contains(stage)) << stage;
    }
    EXPECT_TRUE(run["cold"]["model_milliseconds"].contains("cold"));
    EXPECT_FALSE(run["warm"]["model_milliseconds"].empty());
  }
  EXPECT_EQ(result["runs"][0]["speedup"], 1);
  EXPECT_EQ(result["runs"][0]["psnr"], result["runs"][1]["psnr"]);
}

TEST_F(CliBench, ItPrintsABlockPerClipOrMarkdown) {
  measured({"--threads", "2"});
  EXPECT_NE(output_.find("\nstatic 64x36, 4 frames, fast\n"), std::string::npos) << output_;
  EXPECT_NE(output_.find("  fps passthrough "), std::string::npos) << output_;
  EXPECT_NE(output_.find("  ms per warm frame\n"), std::string::npos) << output_;
  measured({"--threads", "2", "--markdown"});
  EXPECT_NE(output_.find("| static | 64x36 | fast | 2 |"), std::string::npos) << output_;
  EXPECT_EQ(output_.find("ms per warm frame"), std::string::npos);
}

TEST_F(CliBench, FilesAreCutAndScaledBeforehand) {
  const std::string clip = path("clip.mkv");
  test::write_clip(clip, 6);
  expect_success(knotreel({"bench", clip, "--size", "80x60", "--frames", "3", "--preset", "fast", "--threads",
                           "1", "--json", result_}));
  const json run = json::parse(read_text(result_))["runs"][0];
  EXPECT_EQ(run["clip"], "clip.mkv");
  EXPECT_EQ(run["size"], "80x60");
  EXPECT_EQ(run["frames"], 3);
}

TEST_F(CliBench, AResultComparedWithItselfHasRatiosOfOne) {
  measured({"--threads", "1"});
  const auto result = knotreel({"bench", "--compare", result_, result_});
  expect_success(result);
  const auto lines = figure_lines(result.out);
  EXPECT_GT(lines.size(), 30u);
  for (const std::string& line : lines) EXPECT_TRUE(line.ends_with(" 1.000")) << line;
}

TEST_F(CliBench, ComparisonMarksWhatDiffers) {
  json result = measured({"--threads", "1"});
  const std::string other = path("other.json");
  result["runs"][0]["fps"] = 0.8 * result["runs"][0]["fps"].get<double>();
  result["runs"][0]["psnr"] = 0.3 + result["runs"][0]["psnr"].get<double>();
  test::write_text(other, result.dump());
  std::string marked;
  for (const std::string& line : figure_lines(knotreel({"bench", "--compare", result_, other}).out)) {
    if (line.ends_with(" *")) marked += line.substr(2, line.find(' ', 2) - 2) + " ";
  }
  EXPECT_EQ(marked, "fps psnr ");
  result["runs"][0]["preset"] = "fine";
  test::write_text(other, result.dump());
  const std::string text = knotreel({"bench", "--compare", result_, other, "--threshold", "50"}).out;
  EXPECT_NE(text.find("static 64x36 fast, threads: 1: only before\n"), std::string::npos) << text;
  EXPECT_NE(text.find("static 64x36 fine, threads: 1: only after\n"), std::string::npos) << text;
}

TEST_F(CliBench, ErrorsAreThoseOfTheRuns) {
  expect_failure(knotreel({"bench", "--compare", path("no.json"), path("no.json")}), 3);
  measured({"--threads", "1"});
  const std::string head = R"({"commit": "c", "date": "d", "runs": )";
  for (const std::string& text :
       {std::string("{\"runs\":[]}"), std::string("[]"), std::string("{"), head + "[{}]}", head + "[5]}",
        head + R"([{"clip": 1, "size": "s", "preset": "p", "threads": 1}]})",
        head + R"([{"clip": "c", "size": "s", "preset": "p"}]})"}) {
    SCOPED_TRACE(text);
    test::write_text(path("wrong.json"), text);
    for (const auto& files : {std::pair{path("wrong.json"), result_}, {result_, path("wrong.json")}}) {
      const auto result = knotreel({"bench", "--compare", files.first, files.second});
      expect_failure(result, 3);
      EXPECT_NE(result.err.find("wrong.json"), std::string::npos) << result.err;
    }
  }
  expect_failure(knotreel({"bench", path("no.mp4")}), 3);
  const auto unwritable = knotreel({"bench", path("no.mp4"), "--json", path("no/result.json")});
  expect_failure(unwritable, 4);  // told before the clips are looked at
  const auto wrong = knotreel({"bench", "static", "--size", "64x36", "--frames", "2", "--threads", "1",
                               "--transcode-options", "--no-such-option"});
  EXPECT_EQ(wrong.exit_code, 2) << wrong.err;
}

TEST_F(CliBench, WhatCannotApplyIsRefused) {
  measured({"--threads", "1"});
  const std::string clip = path("clip.mkv"), video = path("out.mkv");
  test::write_clip(clip, 3);
  const auto refused = [&](std::vector<std::string> arguments, const std::string& why) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    arguments.insert(arguments.begin(), "bench");
    const auto result = knotreel(arguments);
    expect_failure(result, 2);
    EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
  };
  const auto compare = [&](const std::vector<std::string>& more, const std::string& why) {
    std::vector<std::string> arguments{"--compare", result_, result_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    refused(arguments, why);
  };
  compare({"--size", "64x36"}, "--size is of no use with --compare");
  compare({"--markdown"}, "--markdown is of no use with --compare");
  compare({"--json", path("o.json")}, "--json is of no use with --compare");
  compare({"--passthrough", video}, "--passthrough is of no use with --compare");
  compare({"--crf", "20"}, "--crf is of no use with --compare");
  refused({"static", "--compare", result_, result_}, "clips are of no use with --compare");
  const auto pass = [&](const std::vector<std::string>& more, const std::string& why) {
    std::vector<std::string> arguments{clip, "--passthrough", video};
    arguments.insert(arguments.end(), more.begin(), more.end());
    refused(arguments, why);
  };
  pass({"--frames", "2"}, "--frames is of no use with --passthrough");
  pass({"--preset", "fast"}, "--preset is of no use with --passthrough");
  pass({"--threshold", "5"}, "--threshold is of no use with --passthrough");
  pass({"--threads", "1,2"}, "--passthrough takes one number of threads");
  pass({clip}, "--passthrough takes one clip");
  refused({clip, "--threshold", "5"}, "--threshold is for --compare");
  expect_success(knotreel({"bench", clip, "--passthrough", video, "--threads", "1", "--codec", "ffv1"}));
}

/// The signal goes to the program alone, while a run of its own goes on that would take minutes.
TEST_F(CliBench, ASignalEndsTheRunAndLeavesNothing) {
  const std::string temporary = path("temporary");
  const std::string script = "mkdir '" + temporary + "' && export TMPDIR='" + temporary + "' || exit 99\n'" +
                             KNOTREEL_PROGRAM +
                             "' bench pan --size 96x64 --frames 300 --preset fine --threads 1 &\n"
                             "bench=$!\n"
                             "until [ -n \"$(find $TMPDIR -name 'out.tcb*')\" ]; do sleep 0.05; done\n"
                             "kill -TERM $bench; wait $bench";
  const auto result = test::run({"/bin/sh", "-c", script});
  expect_failure(result, 130);
  EXPECT_TRUE(std::filesystem::is_empty(temporary));
}

}  // namespace
}  // namespace knotreel
