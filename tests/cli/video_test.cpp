// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "knotreel/document/reader.h"
#include "knotreel/image/read_image.h"
#include "program.h"
#include "support/clips.h"

namespace knotreel {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::knotreel;
using test::read_text;

constexpr int kVideoFrames = 6;

/// A folder with a small video.
class CliVideo : public testing::Test {
 protected:
  CliVideo() : times_(test::write_clip(clip_, kVideoFrames)) {}

  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  /// Of a frame, as --start takes it.
  std::string time(std::size_t frame) const {
    std::ostringstream text;
    text << double(times_[frame] - times_[0]) / 1000;
    return text.str();
  }

  void vectorize() { expect_success(knotreel({"vectorize", clip_, "-o", document_, "--preset", "fast"})); }

  test::TempDir dir_;
  std::string clip_ = (dir_ / "clip.mkv").string();
  std::string document_ = (dir_ / "clip.tcb").string();
  std::vector<std::int64_t> times_;
};

TEST_F(CliVideo, TranscodeKeepsFramesAndTimes) {
  const auto result = knotreel({"transcode", clip_, "-o", path("out.mkv"), "--codec", "ffv1", "--preset",
                                "fast", "--document", document_});
  expect_success(result);
  EXPECT_NE(result.out.find("6 frames"), std::string::npos) << result.out;
  EXPECT_EQ(test::frame_times(path("out.mkv")), times_);
  const json info = json::parse(knotreel({"info", document_, "--json"}).out);
  ASSERT_EQ(info["frames"].size(), times_.size());
  for (std::size_t i = 0; i < times_.size(); ++i) EXPECT_EQ(info["frames"][i]["pts"], times_[i]);
}

TEST_F(CliVideo, QuietRunsTellNothing) {
  const std::vector<std::vector<std::string>> runs = {
      {"transcode", clip_, "-o", path("out.mkv"), "--codec", "ffv1", "--preset", "fast"},
      {"vectorize", clip_, "-o", document_, "--preset", "fast"},
      {"render", document_, "-o", path("drawn.mkv"), "--codec", "ffv1"},
      {"render", document_, "--frame", "1", "-o", path("in/frame.png")},
      {"copy", document_, "-o", path("part.tcb"), "--frames", "2-4"},
      {"export", document_, "--frame", "1", "-o", path("frame.svg")},
      {"vectorize", path("in/frame.png"), "-o", path("frame.tcb"), "--preset", "fast"},
      {"batch", path("in"), "-o", path("many"), "--preset", "fast"}};
  std::filesystem::create_directory(path("in"));
  for (std::vector<std::string> run : runs) {
    run.emplace_back("-q");
    const auto result = knotreel(run);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, "") << run[0];
    EXPECT_EQ(result.err, "") << run[0];
  }
  // What asks for something is answered, and what fails says so.
  EXPECT_NE(knotreel({"transcode", clip_, "-q", "-f", "hash", "--preset", "fast"}).out, "");
  expect_failure(knotreel({"vectorize", path("none.png"), "-q", "-o", path("none.tcb")}), 3);
}

/// Flat colours: a disc that moves over a box.
image::Image drawn_picture(int frame) {
  image::Image image = image::make_image(120, 90, 3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double distance = std::hypot(x + 0.5 - 30 - 1.5 * frame, y + 0.5 - 45);
      const double disc = std::clamp(20 - distance + 0.5, 0.0, 1.0);
      const double ground = x > 60 && x < 105 && y > 20 && y < 70 ? 60 : 230;
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = float((1 - disc) * ground + disc * (c == 0 ? 220 : 40));
    }
  }
  return image;
}

/// Of `transcode` without an output.
json stats_of(const std::string& input, const std::string& stats, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"transcode", input, "-f", "null", "--stats", stats};
  arguments.insert(arguments.end(), more.begin(), more.end());
  expect_success(knotreel(arguments));
  return json::parse(read_text(stats));
}

TEST_F(CliVideo, DrawnFramesCanBeMadeAsFilm) {
  for (int i = 0; i < 4; ++i)
    image::write_image(path("drawn_" + std::to_string(i) + ".png"), drawn_picture(i));
  const auto stats = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--max-control-points", "1000"});
    return stats_of(path("drawn_%d.png"), path("stats.json"), more);
  };
  const json drawn = stats({});
  const json film = stats({"--no-drawn-frames"});
  EXPECT_EQ(drawn["tracking"]["drawn_frames"], true);
  EXPECT_EQ(film["tracking"]["drawn_frames"], false);
  EXPECT_EQ(stats({"--no-features"})["tracking"]["drawn_frames"], false);
  EXPECT_GT(test::json_psnr(drawn), test::json_psnr(film) + 2);
  for (const json& f : film["frames"]) EXPECT_FALSE(f["milliseconds"].contains("curves")) << f;
  EXPECT_EQ(drawn["tracking"]["drawn_max_control_points"], 1000);
  EXPECT_EQ(film["tracking"]["drawn_max_control_points"], 0);
  EXPECT_EQ(drawn["tracking"]["dense_max_control_points"], 0) << "the bound is given";
  EXPECT_EQ(drawn["tracking"]["dense_film_max_control_points"], 0);
  EXPECT_EQ(drawn["tracking"]["cramped_max_control_points"], 0);
  EXPECT_EQ(drawn["tracking"]["drawn_fine_grid"], true);
  EXPECT_EQ(stats({"--fine-grid", "none"})["tracking"]["drawn_fine_grid"], false);
}

TEST_F(CliVideo, SmallVideosHaveMoreControlPointsAndDrawnOnesMore) {
  for (int i = 0; i < 3; ++i) {
    image::Image picture = drawn_picture(i);
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const bool in_bar = (x + i) % 30 < 17 && y % 24 > 9;
        for (int c = 0; c < 3 && in_bar; ++c) picture.at(x, y, c) = c == 1 ? 90.0F : 20.0F;
      }
    }
    image::write_image(path("drawn_" + std::to_string(i) + ".png"), picture);
  }
  const json drawn = stats_of(path("drawn_%d.png"), path("stats.json"), {});
  const json film = stats_of(path("drawn_%d.png"), path("stats.json"), {"--no-drawn-frames"});
  EXPECT_EQ(drawn["options"]["max_control_points"], 1500);
  EXPECT_EQ(drawn["tracking"]["drawn_max_control_points"], 120 * 90 / 5);
  EXPECT_EQ(drawn["tracking"]["dense_max_control_points"], 120 * 90 / 5);
  const json fast = stats_of(path("drawn_%d.png"), path("stats.json"), {"--preset", "fast"});
  EXPECT_EQ(drawn["tracking"]["dense_film_max_control_points"], 120 * 90 / 5);
  EXPECT_EQ(fast["tracking"]["dense_max_control_points"], 0);
  EXPECT_EQ(drawn["tracking"]["cramped_max_control_points"], 120 * 90 * 3 / 10);
  EXPECT_EQ(fast["tracking"]["dense_film_max_control_points"], 0);
  EXPECT_EQ(fast["tracking"]["cramped_max_control_points"], 0);
  for (const json& f : film["frames"]) EXPECT_LE(f["control_points"], 1500) << f;
  EXPECT_GT(test::json_psnr(drawn), test::json_psnr(film) + 6);
}

/// Small text is lost by default, and the user is told what would keep it.
TEST_F(CliVideo, SmallTextAsksForMoreControlPoints) {
  for (int i = 0; i < 2; ++i) {
    image::Image page = image::make_image(420, 330, 1);
    std::ranges::fill(page.samples, 250.0F);
    for (int y = 4; y < 320; ++y) {
      for (int x = 4; x < 410; ++x) {
        const int letter = x / 11 * 7 + y / 17 * 5, u = x % 11, v = y % 17;
        const bool stroke = u == 1 || (letter % 2 == 0 && v == 2 && u < 7) ||
                            (letter % 3 == 0 && v == 6 && u < 7) || (letter % 5 > 1 && u == 6);
        if (u > 0 && u < 7 && v > 1 && v < 11 && stroke) page.at(x, y, 0) = 20;
      }
    }
    page.at(1, 1, 0) = float(100 * i);
    image::write_image(path("page_" + std::to_string(i) + ".png"), page);
  }
  const auto told = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"transcode", path("page_%d.png"), "-f", "null"});
    const auto result = knotreel(more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.err;
  };
  const std::string text = told({});
  EXPECT_NE(text.find("warning: frame 0 is a drawing with more edges"), std::string::npos) << text;
  EXPECT_NE(text.find("--max-control-points"), std::string::npos) << text;
  EXPECT_EQ(told({"--no-drawn-frames"}).find("small text"), std::string::npos) << "it was not to be drawn";
}

TEST_F(CliVideo, OneFrameIsNotCalledFrames) {
  image::write_image(path("in_1.png"), test::moving_picture(48, 32, 3, 0));
  const auto result = knotreel({"vectorize", path("in_%d.png"), "-o", document_, "--preset", "fast"});
  expect_success(result);
  EXPECT_NE(result.out.find(": 1 frame in "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find(", 1 keyframe, "), std::string::npos) << result.out;
}

TEST_F(CliVideo, ARateOfPicturesForAVideoIsToldToBeOfNoUse) {
  const auto told = [&](const std::string& input, const std::string& format = "") {
    std::vector<std::string> arguments{"transcode", input,  "-f",           "null",
                                       "--preset",  "fast", "--image-rate", "30"};
    if (!format.empty()) arguments.insert(arguments.end(), {"--input-format", format});
    const auto result = knotreel(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.err;
  };
  EXPECT_NE(told(clip_).find("warning: --image-rate is not used"), std::string::npos);
  image::write_image(path("in_1.png"), test::moving_picture(48, 32, 3, 0));
  EXPECT_EQ(told(path("in_%d.png")), "");
  EXPECT_EQ(told(path("in_1.png"), "png_pipe"), "");
}

TEST_F(CliVideo, ANumberInTheNameOfADocumentIsToldOf) {
  const std::string numbered = path("d_%d.tcb");
  const auto told = [&](std::vector<std::string> arguments) {
    const auto result = knotreel(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.err.find("--split DIR writes one for each") != std::string::npos;
  };
  EXPECT_TRUE(told({"vectorize", clip_, "-o", numbered, "--preset", "fast", "--frames", "0-1"}));
  EXPECT_TRUE(std::filesystem::exists(numbered));
  EXPECT_TRUE(told({"copy", numbered, "-o", path("e_%d.tcb")}));
  EXPECT_FALSE(told({"copy", numbered, "-o", path("e.tcb")}));
  EXPECT_FALSE(told({"copy", numbered, "-o", path("f_%d.tcb"), "--split", path("frames")}));
}

TEST_F(CliVideo, AllWildcardsMeanPictures) {
  for (const char* name : {"in_1.png", "in_2.png", "in_[3].png"}) {
    image::write_image(path(name), test::moving_picture(48, 32, 3, 0));
  }
  for (const char* pattern : {"in_[0-9].png", "in_?.png", "in_%d.png"}) {
    SCOPED_TRACE(pattern);
    expect_success(knotreel({"vectorize", path(pattern), "-o", document_, "--preset", "fast"}));
    EXPECT_EQ(json::parse(knotreel({"info", document_, "--json"}).out)["frame_count"], 2);
  }
  expect_success(knotreel({"vectorize", path("in_[3].png"), "-o", document_, "--preset", "fast"}));
  EXPECT_EQ(json::parse(knotreel({"info", document_, "--json"}).out)["frame_count"], 1);
}

TEST_F(CliVideo, APercentSignAloneIsNoNumber) {
  vectorize();
  expect_success(knotreel({"render", document_, "-o", path("100%%d.png"), "--frame", "2"}));
  EXPECT_TRUE(std::filesystem::exists(path("100%%d.png")));
}

TEST_F(CliVideo, Mp4KeepsVariableTimes) {
  const auto result =
      knotreel({"transcode", clip_, "-o", path("out.mp4"), "--preset", "fast", "--pixel-format", "yuv420p"});
  expect_success(result);
  EXPECT_EQ(test::frame_times(path("out.mp4")), times_);
}

TEST_F(CliVideo, TranscodeScales) {
  expect_success(knotreel({"transcode", clip_, "-o", path("o.mkv"), "--preset", "fast", "--scale", "1.5"}));
  const video::VideoReader reader = video::VideoReader::open(path("o.mkv"));
  EXPECT_EQ(reader.info().width, 96);
  EXPECT_EQ(reader.info().height, 72);
}

TEST_F(CliVideo, TheDigestDoesNotDependOnTheNumberOfThreads) {
  std::string first;
  for (const std::string threads : {"1", "2", "3"}) {
    const auto result =
        knotreel({"transcode", clip_, "-f", "hash", "--preset", "fast", "--threads", threads});
    expect_success(result);
    EXPECT_TRUE(result.out.starts_with("sha256:")) << result.out;
    if (first.empty()) first = result.out;
    EXPECT_EQ(result.out, first) << threads;
  }
}

TEST_F(CliVideo, TranscodeEqualsVectorizeAndRender) {
  vectorize();
  const auto at_once =
      knotreel({"transcode", clip_, "-f", "null", "--preset", "fast", "--document", path("t.tcb")});
  expect_success(at_once);
  EXPECT_TRUE(read_text(path("t.tcb")) == read_text(document_));
  expect_success(knotreel({"render", document_, "-o", path("out.mkv"), "--codec", "ffv1"}));
  EXPECT_EQ(test::frame_times(path("out.mkv")), times_);
}

TEST_F(CliVideo, APartOfAVideoIsMadeAlone) {
  const auto made = knotreel({"transcode", clip_, "-o", path("part.mkv"), "--codec", "ffv1", "--preset",
                              "fast", "--document", document_, "--frames", "2-4"});
  expect_success(made);
  EXPECT_NE(made.out.find("3 frames"), std::string::npos) << made.out;
  std::vector<std::int64_t> expected(times_.begin() + 2, times_.begin() + 5);
  for (std::int64_t& t : expected) t -= times_[2];
  EXPECT_EQ(test::frame_times(path("part.mkv")), expected);
  // The document keeps the clock of the source.
  const json info = json::parse(knotreel({"info", document_, "--json"}).out);
  ASSERT_EQ(info["frames"].size(), 3u);
  EXPECT_EQ(info["frames"][0]["pts"], times_[2]);
  expect_success(knotreel({"render", document_, "-o", path("again.mkv"), "--codec", "ffv1"}));
  EXPECT_EQ(test::frame_times(path("again.mkv")), expected);
  const auto short_part =
      knotreel({"vectorize", clip_, "-o", path("short.tcb"), "--preset", "fast", "--frames", "4-9"});
  EXPECT_EQ(short_part.exit_code, 0);
  EXPECT_NE(short_part.err.find("ends after 2 of these 6 frames"), std::string::npos) << short_part.err;
  for (const char* wrong : {"4-2", "a", "-3", "1-2-3", "2.5", ""}) {
    expect_failure(knotreel({"vectorize", clip_, "-o", path("x.tcb"), std::string("--frames=") + wrong}), 2);
  }
  expect_failure(knotreel({"vectorize", clip_, "-o", path("x.tcb"), "--frames", "6-"}), 2);
}

TEST_F(CliVideo, APartOfAVideoCanBeToldByTimes) {
  const auto made = [&](const std::string& name, std::vector<std::string> part) {
    part.insert(part.begin(), {"vectorize", clip_, "-o", path(name), "--preset", "fast"});
    expect_success(knotreel(part));
    return read_text(path(name));
  };
  const std::string expected = made("by_number.tcb", {"--frames", "2-4"});
  EXPECT_TRUE(made("by_time.tcb", {"--start", time(2), "--end", time(5)}) == expected);
  EXPECT_TRUE(made("by_minutes.tcb", {"--start", "0:00:" + time(2), "--end", "0:" + time(5)}) == expected);
  for (const char* wrong : {"1:60", "1:2:3:4", ":1", "1:", "-1", "a", "", "1.5:0", "1e99"}) {
    SCOPED_TRACE(wrong);
    expect_failure(knotreel({"vectorize", clip_, "-o", path("x.tcb"), std::string("--start=") + wrong}), 2);
  }
  expect_failure(knotreel({"vectorize", clip_, "-o", path("x.tcb"), "--start", "2", "--end", "2"}), 2);
  expect_failure(knotreel({"vectorize", clip_, "-o", path("x.tcb"), "--start", "100"}), 2);
  expect_failure(knotreel({"vectorize", clip_, "-o", path("x.tcb"), "--start", "0", "--frames", "1-2"}), 2);
}

TEST_F(CliVideo, RenderTakesPartsByTheirTimes) {
  vectorize();
  const auto drawn = [&](std::vector<std::string> part) {
    part.insert(part.begin(), {"render", document_, "-o", "-", "-f", "hash"});
    const auto result = knotreel(part);
    expect_success(result);
    return result.out;
  };
  EXPECT_EQ(drawn({"--start", time(2), "--end", time(5)}), drawn({"--frames", "2-4"}));
  EXPECT_EQ(drawn({"--start", time(4)}), drawn({"--frames", "4-"}));
  EXPECT_EQ(drawn({"--end", time(1)}), drawn({"--frames", "0"}));
  EXPECT_NE(drawn({"--end", time(1)}), drawn({}));
}

TEST_F(CliVideo, RenderMakesPicturesOfARange) {
  vectorize();
  expect_success(knotreel({"render", document_, "-o", path("f_%02d.png"), "--frames", "2-4"}));
  expect_success(knotreel({"render", document_, "-o", path("third.png"), "--frame", "3"}));
  EXPECT_FALSE(std::filesystem::exists(path("f_04.png")));
  EXPECT_TRUE(read_text(path("f_02.png")) == read_text(path("third.png")));
  expect_failure(knotreel({"render", document_, "-o", path("x.mkv"), "--frames", "4-6"}), 2);
  expect_failure(knotreel({"render", document_, "-o", path("x.mkv"), "--start", "100"}), 2);
  expect_failure(knotreel({"render", document_, "-o", path("x.mkv"), "--start", "0", "--frames", "1"}), 2);
  // What would be without effect is refused, rather than another frame drawn.
  expect_failure(knotreel({"render", document_, "-o", path("x.png"), "--frames", "3"}), 2);
  expect_failure(knotreel({"render", document_, "-o", path("x.png"), "--fps", "50"}), 2);
  expect_failure(knotreel({"render", document_, "-o", path("x.mkv"), "--frame", "3"}), 2);
}

TEST_F(CliVideo, RenderCopiesStreams) {
  vectorize();
  const auto result = knotreel({"render", document_, "-o", path("o.mkv"), "--copy-streams", clip_});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("neither sound nor subtitles"), std::string::npos) << result.err;
  EXPECT_EQ(test::frame_times(path("o.mkv")), times_);
  expect_failure(knotreel({"render", document_, "-o", path("x.png"), "--copy-streams", clip_}), 2);
  expect_failure(knotreel({"render", document_, "-o", path("x.mkv"), "--copy-streams", path("none.mkv")}), 3);
  expect_failure(knotreel({"render", "-", "-o", path("x.mkv"), "--copy-streams", "-"}), 2);
  expect_failure(knotreel({"render", document_, "-o", path("x_%d.png"), "--copy-streams", clip_}), 2);
  expect_failure(knotreel({"render", document_, "-f", "hash", "-o", "-", "--copy-streams", clip_}), 2);
  EXPECT_FALSE(std::filesystem::exists(path("x.mkv")));
}

TEST_F(CliVideo, RenderCutsPartsOutOfVideos) {
  vectorize();
  const std::vector<std::string> part{"--crop", "8,4,33,25", "--scale", "1.5"};
  const auto render = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), part.begin(), part.end());
    return knotreel(arguments);
  };
  expect_success(render({"render", document_, "-o", path("f_%02d.png")}));
  expect_success(render({"render", document_, "-o", path("third.png"), "--frame", "3"}));
  EXPECT_TRUE(read_text(path("f_04.png")) == read_text(path("third.png")));
  expect_failure(knotreel({"render", document_, "-o", path("o.mkv"), "--crop", "40,0,30,20"}), 2);
}

TEST_F(CliVideo, RenderPutsFramesWithAlphaOnABackground) {
  std::filesystem::create_directory(path("in"));
  for (int i = 0; i < 3; ++i) {
    image::write_image(path("in/p" + std::to_string(i) + ".png"), test::moving_picture(48, 32, 4, i));
  }
  expect_success(knotreel({"vectorize", path("in"), "-o", document_, "--preset", "fast"}));
  expect_success(knotreel({"render", document_, "-o", path("f_%d.png"), "--background", "#40ff20"}));
  expect_success(
      knotreel({"render", document_, "-o", path("second.png"), "--frame", "1", "--background", "#40ff20"}));
  EXPECT_TRUE(read_text(path("f_2.png")) == read_text(path("second.png")));
  expect_success(knotreel({"render", document_, "-o", path("o.mkv"), "--background", "black", "--size",
                           "48x32", "--codec", "ffv1"}));
  EXPECT_EQ(video::VideoReader::open(path("o.mkv")).info().channels, 3);
}

TEST_F(CliVideo, ABackgroundLeavesTheColoursOfPicturesAtFullSize) {
  std::filesystem::create_directory(path("in"));
  image::write_image(path("in/p.png"), test::moving_picture(48, 32, 4, 0));
  const auto format_of = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"transcode", path("in"), "-o", path(name), "--preset", "fast"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(knotreel(arguments).exit_code, 0);
    return video::VideoReader::open(path(name)).info().pixel_format;
  };
  EXPECT_EQ(format_of("a.mp4", {"--background", "black"}), "yuv444p");
  EXPECT_TRUE(format_of("b.mov", {"--codec", "prores", "--background", "black"}).starts_with("yuv444p1"));
}

TEST_F(CliVideo, TranscodePutsFramesWithAlphaOnABackground) {
  std::filesystem::create_directory(path("in"));
  for (int i = 0; i < 3; ++i) {
    image::write_image(path("in/p" + std::to_string(i) + ".png"), test::moving_picture(48, 32, 4, i));
  }
  const std::vector<std::string> on{"--codec", "ffv1", "--pixel-format", "bgr0", "--background", "#40ff20"};
  std::vector<std::string> arguments{"transcode",  path("in"), "-o",       path("t.mkv"),
                                     "--document", document_,  "--preset", "fast"};
  arguments.insert(arguments.end(), on.begin(), on.end());
  expect_success(knotreel(arguments));
  arguments = {"render", document_, "-o", path("r.mkv")};
  arguments.insert(arguments.end(), on.begin(), on.end());
  expect_success(knotreel(arguments));
  const auto frames = [&](const char* name) {
    video::VideoReader reader = video::VideoReader::open(path(name));
    EXPECT_EQ(reader.info().channels, 3);
    std::vector<std::vector<float>> all;
    for (video::Frame frame; reader.next(frame);) all.push_back(std::move(frame.image.samples));
    return all;
  };
  EXPECT_TRUE(frames("t.mkv") == frames("r.mkv"));
  EXPECT_EQ(frames("t.mkv").size(), 3u);
  expect_failure(knotreel({"transcode", path("in"), "-f", "null", "--background", "green"}), 2);
}

TEST_F(CliVideo, ColoursThatAlphaHidesDoNotMatter) {
  const auto document_of = [&](bool noise) {
    std::filesystem::create_directories(path("in"));
    for (int i = 0; i < 4; ++i) {
      image::Image picture = test::moving_picture(48, 32, 4, i);
      const image::Image hidden = test::random_8bit_picture(48, 32, 4, static_cast<unsigned>(i));
      for (std::size_t k = 0; k < picture.samples.size(); k += 4) {
        const bool seen = picture.samples[k] > 100;
        picture.samples[k + 3] = seen ? 255 : 0;
        for (std::size_t c = 0; c < 3 && !seen; ++c)
          picture.samples[k + c] = noise ? hidden.samples[k + c] : 0;
      }
      image::write_image(path("in/p" + std::to_string(i) + ".png"), picture);
    }
    expect_success(knotreel({"vectorize", path("in"), "-o", document_, "--preset", "fast"}));
    return read_text(document_);
  };
  EXPECT_TRUE(document_of(true) == document_of(false));
}

TEST_F(CliVideo, RenderStatsTellOfEveryFrame) {
  vectorize();
  expect_success(knotreel({"render", document_, "-o", path("o.mkv"), "--stats", path("s.json")}));
  const json stats = json::parse(read_text(path("s.json")));
  EXPECT_EQ(stats["width"], 64);
  EXPECT_EQ(stats["frame_count"], kVideoFrames);
  ASSERT_EQ(stats["frames"].size(), times_.size());
  for (std::size_t i = 0; i < times_.size(); ++i) {
    EXPECT_EQ(stats["frames"][i]["pts"], times_[i]);
    EXPECT_GT(stats["frames"][i]["bytes"], 0);
  }
}

TEST_F(CliVideo, AVideoMayComeThroughAPipe) {
  const auto result =
      knotreel({"vectorize", "-", "-o", document_, "--preset", "fast"}, {.input = read_text(clip_)});
  expect_success(result);
  EXPECT_EQ(document::Reader::open(document_).frame_count(), std::size_t{kVideoFrames});
  expect_failure(knotreel({"vectorize", "-", "-o", document_}, {.input = ""}), 3);
  expect_failure(knotreel({"vectorize", "-", "-o", document_}, {.input = "neither"}), 3);
}

/// An MP4 file as large as real ones: bytes that nobody asks for come between the packets and the index.
std::string with_distant_index(std::string mp4) {
  constexpr std::size_t kPadding = 1 << 20;
  const std::size_t packets = mp4.find("mdat") - 4, index = mp4.find("moov") - 4;
  mp4.insert(index, kPadding, '\0');
  const std::size_t size = index + kPadding - packets;
  for (int i = 0; i < 4; ++i) mp4[packets + std::size_t(i)] = char(size >> (24 - 8 * i) & 0xff);
  return mp4;
}

TEST_F(CliVideo, AnMp4FromAPipeNeedsItsIndexFirst) {
  expect_success(
      knotreel({"transcode", clip_, "-o", path("o.mp4"), "--preset", "fast", "--pixel-format", "yuv420p"}));
  const std::string mp4 = with_distant_index(read_text(path("o.mp4")));
  const auto result = knotreel({"vectorize", "-", "-o", document_}, {.input = mp4});
  expect_failure(result, 3);
  EXPECT_NE(result.err.find("faststart"), std::string::npos) << result.err;
  test::write_text(path("o.mp4"), mp4);
  expect_success(knotreel({"vectorize", path("o.mp4"), "-o", document_, "--preset", "fast"}));
}

TEST_F(CliVideo, ASizeThatNoEncoderTakesIsNamed) {
  const auto result = knotreel({"transcode", clip_, "-o", path("o.mp4"), "--size", "100000x100000"});
  expect_failure(result, 2);
  EXPECT_NE(result.err.find("100000x100000"), std::string::npos) << result.err;
}

TEST_F(CliVideo, DebugPicturesHaveAFolderPerFrame) {
  expect_success(
      knotreel({"vectorize", clip_, "-o", document_, "--preset", "fast", "--debug-dir", path("stages")}));
  for (int i = 1; i <= kVideoFrames; ++i) {
    const std::string folder = path("stages/frame_00000" + std::to_string(i));
    EXPECT_EQ(std::filesystem::exists(folder + "/05-knots.png"), i == 1) << i;
    for (const char* name : {"mesh", "fit", "error", "control-net"}) {
      EXPECT_TRUE(std::filesystem::exists(folder + "/stored-" + name + ".png")) << folder << name;
    }
  }
}

TEST_F(CliVideo, AFolderOfPicturesIsAVideo) {
  std::filesystem::create_directory(path("in"));
  for (int i = 0; i < 3; ++i) {
    image::write_image(path("in/p" + std::to_string(i) + ".png"), test::moving_picture(48, 32, 3, i));
  }
  for (const std::string& input : {path("in"), path("in/p%d.png"), path("in/*.png")}) {
    expect_success(knotreel({"vectorize", input, "-o", document_, "--preset", "fast"}));
    EXPECT_EQ(json::parse(knotreel({"info", document_, "--json"}).out)["frames"].size(), 3u) << input;
  }
}

TEST_F(CliVideo, SplitWritesADocumentPerFrame) {
  expect_success(knotreel({"vectorize", clip_, "--split", path("split"), "--preset", "fast"}));
  for (int i = 1; i <= kVideoFrames; ++i) {
    const std::string name = path("split/frame_00000" + std::to_string(i) + ".tcb");
    expect_success(knotreel({"render", name, "-o", path("one.png")}));
  }
}

TEST_F(CliVideo, StatsAndProgressTellOfEveryFrame) {
  expect_success(knotreel({"transcode", clip_, "-f", "null", "--preset", "fast", "--max-control-points",
                           "1500", "--stats", path("s.json"), "--progress", path("p.txt")}));
  const json stats = json::parse(read_text(path("s.json")));
  EXPECT_EQ(stats["frame_count"], kVideoFrames);
  EXPECT_EQ(stats["width"], 64);
  ASSERT_EQ(stats["frames"].size(), std::size_t{kVideoFrames});
  for (std::size_t i = 0; i < times_.size(); ++i) {
    const json& row = stats["frames"][i];
    EXPECT_EQ(row["pts"], times_[i]);
    EXPECT_GT(row["psnr"].get<double>(), 20);
    EXPECT_GT(row["meg"].get<double>(), 0);
    EXPECT_LT(row["meg"].get<double>(), 1);
    EXPECT_EQ(row["changes"]["moved"].get<int>() > 0, i > 0);  // the disc moves
    EXPECT_EQ(row["changes"]["held"], 0);
    for (const char* stage : {"decode", "analyse", "model", "documents", "rasterize", "encode"}) {
      EXPECT_TRUE(row["milliseconds"].contains(stage)) << stage;
    }
  }
  const std::string progress = read_text(path("p.txt"));
  EXPECT_NE(progress.find("frame=3\n"), std::string::npos);
  EXPECT_NE(progress.find("out_time_us=80000\n"), std::string::npos);
  EXPECT_TRUE(progress.ends_with("progress=end\n"));
}

TEST_F(CliVideo, FramesThatOthersComeFromTakeFewerRoundsUnlessToldOtherwise) {
  const auto rounds = [&](std::vector<std::string> options) {
    std::vector<std::string> arguments{"transcode", clip_, "-f",      "null",
                                       "--frames",  "0-0", "--stats", path("rounds.json")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    expect_success(knotreel(arguments));
    return json::parse(read_text(path("rounds.json")))["options"]["rounds"].get<int>();
  };
  EXPECT_EQ(rounds({}), 2);
  EXPECT_EQ(rounds({"--no-warm-start"}), 3);
  EXPECT_EQ(rounds({"--rounds", "4"}), 4);
  EXPECT_EQ(rounds({"--preset", "fine"}), 3);
}

TEST_F(CliVideo, TrackingOptionsSayWhichFramesAreMadeAnew) {
  const auto keyframes = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"vectorize", clip_, "-o", document_, "--preset", "fast"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    expect_success(knotreel(arguments));
    const json info = json::parse(knotreel({"info", document_, "--json"}).out);
    std::vector<int> which;
    for (const json& frame : info["frames"]) {
      if (frame["keyframe"]) which.push_back(frame["frame"]);
    }
    return which;
  };
  EXPECT_EQ(keyframes({"--no-warm-start"}), (std::vector{0, 1, 2, 3, 4, 5}));
  const std::vector<int> pairs = keyframes({"--keyframe-interval", "2"});
  EXPECT_GE(pairs.size(), 3u);
}

TEST_F(CliVideo, InfoTellsOfSequences) {
  expect_success(
      knotreel({"vectorize", clip_, "-o", document_, "--preset", "fast", "--keyframe-interval", "4"}));
  const json info = json::parse(knotreel({"info", document_, "--json"}).out);
  EXPECT_EQ(info["frame_count"], kVideoFrames);
  EXPECT_EQ(info["groups"], 2);
  EXPECT_EQ(info["frame_rate"], (json{25, 1}));
  // Every third frame lasts 80 ms, the others 40.
  EXPECT_NEAR(info["seconds"].get<double>(), 0.32, 1e-9);
  const json& knots = info["knots_per_frame"];
  EXPECT_NEAR(knots["mean"].get<double>() * kVideoFrames, info["knots"].get<double>(), 1e-6);
  EXPECT_LE(knots["min"], info["frames"][0]["knots"]);
  EXPECT_GE(knots["max"], info["frames"][0]["knots"]);
  const auto text = knotreel({"info", document_});
  expect_success(text);
  EXPECT_NE(text.out.find("6 in 2 groups"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("0.320 s, 25 frames per second"), std::string::npos) << text.out;
}

TEST_F(CliVideo, InfoTellsOfVideos) {
  const json info = json::parse(knotreel({"info", clip_, "--json"}).out);
  EXPECT_EQ(info["kind"], "video");
  EXPECT_EQ(info["codec"], "ffv1");
  EXPECT_EQ(info["width"], 64);
  EXPECT_EQ(info["height"], 48);
  EXPECT_EQ(info["frame_rate"], (json{25, 1}));
  EXPECT_EQ(info["rotation"], 0);
  ASSERT_EQ(info["streams"].size(), 1u);
  EXPECT_EQ(info["streams"][0]["kind"], "video");
  EXPECT_EQ(info["file_bytes"], std::filesystem::file_size(clip_));
  const auto text = knotreel({"info", clip_});
  expect_success(text);
  EXPECT_NE(text.out.find("ffv1 video\nsize            64x48"), std::string::npos) << text.out;
}

TEST_F(CliVideo, InfoTellsOfColours) {
  video::VideoReader reader = video::VideoReader::open(clip_);
  video::StreamInfo told = reader.info();
  told.colour = {1, 1, 9, 16, 1};
  video::VideoWriter writer = video::VideoWriter::create(path("told.mkv"), told);
  for (video::Frame frame; reader.next(frame);) writer.write(frame.image, frame.pts, frame.duration);
  writer.finish();
  const json colour = json::parse(knotreel({"info", path("told.mkv"), "--json"}).out)["colour"];
  EXPECT_EQ(colour, (json{{"range", "tv"},
                          {"matrix", "bt709"},
                          {"primaries", "bt2020"},
                          {"transfer", "smpte2084"},
                          {"chroma_location", "left"}}));
  const auto text = knotreel({"info", path("told.mkv")});
  EXPECT_NE(text.out.find("colour          range tv, matrix bt709, primaries bt2020, transfer smpte2084, "
                          "chroma left\n"),
            std::string::npos)
      << text.out;
  EXPECT_EQ(knotreel({"info", clip_}).out.find("matrix"), std::string::npos);
}

TEST_F(CliVideo, OnePictureOfManyFramesIsTold) {
  vectorize();
  for (const std::string command : {"render", "export"}) {
    const std::string output = path(command == "render" ? "o.png" : "o.pdf");
    const auto first = knotreel({command, document_, "-o", output});
    EXPECT_EQ(first.exit_code, 0);
    EXPECT_NE(first.err.find("only the first of 6 frames is drawn"), std::string::npos) << first.err;
    expect_success(knotreel({command, document_, "-o", output, "--frame", "0"}));
  }
}

/// One line, without a warning about frames before it.
TEST_F(CliVideo, WrongOptionsAreAllThatIsTold) {
  vectorize();
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{"render", "-o", path("o.png"), "--size", "640x"},
                                             {"render", "-o", path("o.png"), "--crop", "60,0,20,20"},
                                             {"render", "-o", path("o.png"), "--depth", "float"},
                                             {"export", "-o", path("o.pdf"), "--scale", "0"},
                                             {"export", "-o", path("o.pdf"), "--geometry-tolerance", "0"}}) {
    SCOPED_TRACE(testing::PrintToString(wrong));
    std::vector<std::string> arguments = wrong;
    arguments.insert(arguments.begin() + 1, document_);
    expect_failure(knotreel(arguments), 2);
  }
}

TEST_F(CliVideo, NumberedPicturesHaveTheDepthThatIsAskedFor) {
  vectorize();
  const auto depth_of = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", document_, "-o", path(name), "--frames", "0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_success(knotreel(arguments));
    image::ImageFileInfo info;
    image::read_image(path("g_1" + std::filesystem::path(name).extension().string()), &info);
    return info.samples;
  };
  EXPECT_EQ(depth_of("g_%d.tiff", {"--depth", "float"}), image::SampleType::f32);
  EXPECT_EQ(depth_of("g_%d.tiff", {"--depth", "16"}), image::SampleType::u16);
  EXPECT_EQ(depth_of("g_%d.tiff", {"--depth", "8"}), image::SampleType::u8);
  EXPECT_EQ(depth_of("g_%d.pfm", {}), image::SampleType::f32);
  EXPECT_EQ(depth_of("g_%d.pfm", {"--depth", "float"}), image::SampleType::f32);
  EXPECT_EQ(depth_of("g_%d.png", {}), image::SampleType::u8);
  expect_failure(knotreel({"render", document_, "-o", path("h_%d.png"), "--depth", "float"}), 2);
  expect_failure(knotreel({"render", document_, "-o", path("h_%d.jpg"), "--depth", "16"}), 2);
  expect_failure(knotreel({"render", document_, "-o", path("h.mkv"), "--depth", "float"}), 2);
  EXPECT_FALSE(std::filesystem::exists(path("h_1.png")));
}

TEST_F(CliVideo, RenderMakesAnimatedWebpWhereTheFormatSaysSo) {
  vectorize();
  const auto is_animated = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"render", document_, "-o", path("o.webp"), "-f", "webp"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_success(knotreel(arguments));
    return read_text(path("o.webp")).find("ANMF") != std::string::npos;
  };
  EXPECT_TRUE(is_animated({}));
  EXPECT_TRUE(is_animated({"--frames", "1-3"}));
  EXPECT_FALSE(is_animated({"--frame", "1"}));
  expect_success(knotreel({"copy", document_, "-o", path("one.tcb"), "--frames", "0"}));
  expect_success(knotreel({"render", path("one.tcb"), "-o", path("one.webp"), "-f", "webp"}));
  EXPECT_EQ(read_text(path("one.webp")).find("ANMF"), std::string::npos);
}

TEST_F(CliVideo, AGifMayComeFromAPipe) {
  const std::string gif = path("o.gif");
  expect_success(knotreel({"transcode", clip_, "-o", gif, "--preset", "fast", "--scale", "5"}));
  const std::string bytes = read_text(gif);
  ASSERT_GT(bytes.size(), 65536u);  // more than what can be gone back in
  const auto piped = knotreel({"transcode", "-", "-f", "hash", "--preset", "fast"}, {.input = bytes});
  expect_success(piped);
  EXPECT_EQ(piped.out, knotreel({"transcode", gif, "-f", "hash", "--preset", "fast"}).out);
  expect_failure(knotreel({"transcode", "-", "-f", "null"}, {.input = "GIF8"}), 3);
}

TEST_F(CliVideo, SizesAndPartsAreThoseOfThePictureAsShown) {
  video::VideoReader reader = video::VideoReader::open(clip_);
  video::StreamInfo info = reader.info();
  const std::int32_t quarter[9] = {0, 65536, 0, -65536, 0, 0, 0, 0, 1 << 30};  // clockwise: 48x64
  info.display_matrix.resize(sizeof quarter);
  std::memcpy(info.display_matrix.data(), quarter, sizeof quarter);
  video::VideoWriter writer = video::VideoWriter::create(path("phone.mp4"), info);
  for (video::Frame frame; reader.next(frame);) writer.write(frame.image, frame.pts, frame.duration);
  writer.finish();
  const std::string phone = path("phone.mp4"), document = path("phone.tcb");
  expect_success(knotreel({"vectorize", phone, "-o", document, "--preset", "fast"}));
  expect_success(knotreel({"render", document, "--frame", "2", "-o", path("whole.png"), "--scale", "2"}));
  expect_success(knotreel(
      {"render", document, "--frame", "2", "-o", path("part.png"), "--scale", "2", "--crop", "10,20,50,70"}));
  expect_success(
      knotreel({"render", document, "-o", path("p%d.png"), "--scale", "2", "--crop", "10,20,50,70"}));
  const image::Image whole = image::read_image(path("whole.png"));
  ASSERT_EQ(whole.width, 96);
  ASSERT_EQ(whole.height, 128);
  for (const char* name : {"part.png", "p3.png"}) {
    const image::Image part = image::read_image(path(name));
    ASSERT_EQ(part.width, 50);
    ASSERT_EQ(part.height, 70);
    for (int y = 0; y < 70; ++y)
      for (int x = 0; x < 50; ++x) ASSERT_EQ(part.at(x, y, 1), whole.at(x + 10, y + 20, 1)) << name;
  }
  expect_success(knotreel({"transcode", phone, "-o", path("o.mp4"), "--preset", "fast", "--size", "24x32",
                           "--pixel-format", "yuv420p"}));
  EXPECT_EQ(video::VideoReader::open(path("o.mp4")).info().width, 32);
  expect_success(knotreel({"transcode", phone, "-o", path("o.mkv"), "--preset", "fast", "--size", "24x32"}));
  EXPECT_EQ(video::VideoReader::open(path("o.mkv")).info().width, 24);
  const auto compared = knotreel({"compare", phone, document, "--json"});
  expect_success(compared);
  EXPECT_GT(json::parse(compared.out)["psnr"], 25);
}

TEST_F(CliVideo, FormatNullOnlyTells) {
  vectorize();
  const auto result = knotreel({"render", document_, "-o", "-", "-f", "null"});
  expect_success(result);
  EXPECT_TRUE(result.out.starts_with("null: 6 frames")) << result.out;
}

TEST_F(CliVideo, CompareTellsOfEveryFrameAndOfFlicker) {
  const auto equal = knotreel({"compare", clip_, clip_, "--json"});
  expect_success(equal);
  const json same = json::parse(equal.out);
  EXPECT_EQ(same["frames"], kVideoFrames);
  EXPECT_TRUE(same["psnr"].is_null());
  EXPECT_EQ(same["flicker"], 0);
  vectorize();
  const auto result = knotreel({"compare", clip_, document_, "--json", "--stats", path("s.json")});
  expect_success(result);
  EXPECT_GT(json::parse(result.out)["psnr"], 20);
  const json stats = json::parse(read_text(path("s.json")));
  ASSERT_EQ(stats["rows"].size(), std::size_t{kVideoFrames});
  EXPECT_TRUE(stats["rows"][0]["flicker"].is_null());
  EXPECT_GT(stats["rows"][1]["flicker"], 0);
}

TEST_F(CliVideo, CompareTakesGreyWithAlphaBesideColours) {
  std::filesystem::create_directory(path("grey"));
  std::filesystem::create_directory(path("colour"));
  for (int i = 0; i < 2; ++i) {
    const std::string name = "p" + std::to_string(i) + ".png";
    image::write_image(path("grey/" + name), test::moving_picture(48, 32, 2, i));
    image::write_image(path("colour/" + name), test::moving_picture(48, 32, 3, i));
  }
  expect_success(knotreel({"compare", path("grey"), path("colour")}));
  expect_success(knotreel({"compare", path("colour"), path("grey")}));
}

TEST_F(CliVideo, AVideoNeedsNoExtension) {
  const std::string plain = path("clip");
  std::filesystem::copy_file(clip_, plain);
  expect_success(knotreel({"vectorize", plain, "-o", document_, "--preset", "fast"}));
  expect_success(knotreel({"info", plain}));
}

TEST_F(CliVideo, CompareTellsWhichOfTheTwoIsDamaged) {
  const std::string cut = path("cut.mkv");
  std::filesystem::copy_file(clip_, cut);
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
  const auto result = knotreel({"compare", clip_, cut});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("warning: '" + cut + "': the input ends early"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("'" + clip_), std::string::npos) << result.err;
}

TEST_F(CliVideo, FiltersComeBeforeAnythingElse) {
  expect_success(knotreel(
      {"transcode", clip_, "-o", path("out.mkv"), "--preset", "fast", "--filter", "crop=32:24,hflip"}));
  const json info = json::parse(knotreel({"info", path("out.mkv"), "--json"}).out);
  EXPECT_EQ(info["width"], 32);
  EXPECT_EQ(info["height"], 24);
  const auto compared =
      knotreel({"compare", clip_, path("out.mkv"), "--filter", "crop=32:24,hflip", "--json"});
  expect_success(compared);
  EXPECT_GT(json::parse(compared.out)["psnr"].get<double>(), 20);
  const auto wrong = knotreel({"transcode", clip_, "-o", path("no.mkv"), "--filter", "nosuch"});
  expect_failure(wrong, 2);
  EXPECT_NE(wrong.err.find("No such filter: 'nosuch'"), std::string::npos) << wrong.err;
  EXPECT_FALSE(std::filesystem::exists(path("no.mkv")));
}

TEST_F(CliVideo, CompareRefusesWhatWouldBeWithoutEffect) {
  vectorize();
  image::write_image(path("a.png"), test::smooth_picture(64, 48, 3));
  const auto refused = [&](const std::vector<std::string>& command, const std::string& why) {
    SCOPED_TRACE(testing::PrintToString(command));
    const auto result = knotreel(command);
    expect_failure(result, 2);
    EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
  };
  refused({"compare", document_, clip_, "--filter", "hflip"},
          "--filter is for the video A, and '" + document_ + "' is a document");
  refused({"compare", document_, document_, "--deinterlace", "all"}, "both are documents");
  refused({"compare", path("a.png"), path("a.png"), "--deinterlace", "all"}, "--deinterlace is for videos");
  expect_success(knotreel({"compare", document_, clip_, "--deinterlace", "no"}));
}

TEST_F(CliVideo, CompareOpensItsStatsBeforeTheWork) {
  // What comes after would be told otherwise: there are no frames of equal size.
  std::filesystem::create_directory(path("small"));
  image::write_image(path("small/a.png"), test::smooth_picture(32, 24, 3));
  expect_failure(knotreel({"compare", clip_, path("small"), "--stats", path("missing/s.json")}), 4);
  expect_failure(knotreel({"compare", clip_, path("small"), "--stats", path("s.json")}), 2);
  EXPECT_FALSE(std::filesystem::exists(path("s.json")));
}

TEST_F(CliVideo, InfoTellsMirroredFromTurned) {
  struct Shown {
    std::int32_t right_x, right_y, down_x, down_y;
    std::string text;
    int degrees;
    bool mirrored;
  };
  const std::vector<Shown> all{{0, 1, -1, 0, "90 degrees clockwise", 90, false},
                               {-1, 0, 0, -1, "180 degrees clockwise", 180, false},
                               {-1, 0, 0, 1, "mirrored left to right", 0, true},
                               {1, 0, 0, -1, "mirrored top to bottom", 180, true},
                               {0, 1, 1, 0, "mirrored left to right, then -90 degrees clockwise", -90, true},
                               {0, -1, -1, 0, "mirrored left to right, then 90 degrees clockwise", 90, true}};
  for (const Shown& shown : all) {
    SCOPED_TRACE(shown.text);
    video::VideoReader reader = video::VideoReader::open(clip_);
    video::StreamInfo info = reader.info();
    constexpr std::int32_t kOne = 65536;
    const std::int32_t matrix[9] = {kOne * shown.right_x,
                                    kOne * shown.right_y,
                                    0,
                                    kOne * shown.down_x,
                                    kOne * shown.down_y,
                                    0,
                                    0,
                                    0,
                                    1 << 30};
    info.display_matrix.resize(sizeof matrix);
    std::memcpy(info.display_matrix.data(), matrix, sizeof matrix);
    video::VideoWriter writer = video::VideoWriter::create(path("phone.mp4"), info);
    for (video::Frame frame; reader.next(frame);) writer.write(frame.image, frame.pts, frame.duration);
    writer.finish();
    expect_success(knotreel({"vectorize", path("phone.mp4"), "-o", document_, "--preset", "fast"}));
    for (const std::string& file : {path("phone.mp4"), document_}) {
      const std::string text = knotreel({"info", file}).out;
      EXPECT_NE(text.find("\nrotation        shown " + shown.text + "\n"), std::string::npos) << text;
      const json facts = json::parse(knotreel({"info", file, "--json"}).out);
      EXPECT_NEAR(std::remainder(facts["rotation"].get<double>() - shown.degrees, 360), 0, 1e-3);
      EXPECT_EQ(facts["mirrored"], shown.mirrored);
    }
  }
  EXPECT_EQ(knotreel({"info", clip_}).out.find("rotation"), std::string::npos);
}

TEST_F(CliVideo, InterlacedVideosAreDeinterlacedAndSaidToBe) {
  // Two frames of 32x24, whose odd lines are of another brightness in the second.
  const std::string lines = std::string(32, '\x40') + std::string(32, '\x40');
  const std::string combed = std::string(32, '\x40') + std::string(32, '\xa0');
  const auto frame = [](const std::string& pair) {
    std::string bytes = "FRAME\n";
    for (int i = 0; i < 12; ++i) bytes += pair;
    return bytes + std::string(2 * 32 * 24, '\x80');
  };
  test::write_text(path("a.y4m"), "YUV4MPEG2 W32 H24 F25:1 It A1:1 C444\n" + frame(lines) + frame(combed));
  EXPECT_EQ(json::parse(knotreel({"info", path("a.y4m"), "--json"}).out)["first_field"], "top");
  const auto frames_with = [&](const std::string& mode) {
    const auto result = knotreel({"vectorize", path("a.y4m"), "-o", document_, "--deinterlace", mode});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("2 frames are interlaced") != std::string::npos, mode != "no") << result.err;
    return json::parse(knotreel({"info", document_, "--json"}).out)["frame_count"].get<int>();
  };
  EXPECT_EQ(frames_with("auto"), 2);
  EXPECT_EQ(frames_with("fields"), 4);
  EXPECT_EQ(frames_with("no"), 2);
  expect_failure(knotreel({"vectorize", path("a.y4m"), "-o", document_, "--deinterlace", "maybe"}), 2);
}

TEST_F(CliVideo, WhatIsNoVideoIsExit3) {
  std::ofstream(path("no.mp4")) << "this is no video at all, whatever its name says";
  expect_failure(knotreel({"transcode", path("no.mp4"), "-o", path("o.mkv")}), 3);
  expect_failure(knotreel({"vectorize", path("no.mp4"), "-o", document_}), 3);
  expect_failure(knotreel({"transcode", path("missing.mp4"), "-o", path("o.mkv")}), 3);
  EXPECT_FALSE(std::filesystem::exists(path("o.mkv")));
}

TEST_F(CliVideo, ADamagedVideoGivesWhatIsLeft) {
  const std::string damaged = path("damaged.mp4");
  test::write_clip(damaged, 20, 64, 48, "h264");
  std::string bytes = read_text(damaged);
  const std::size_t end = bytes.find("moov");
  std::fill(bytes.begin() + long(end * 7 / 10), bytes.begin() + long(end * 8 / 10), '\xff');
  std::ofstream(damaged, std::ios::binary) << bytes;
  const auto result = knotreel({"transcode", damaged, "-o", path("o.mkv"), "--preset", "fast"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("knotreel: warning: "), std::string::npos) << result.err;
  const std::size_t frames = test::frame_times(path("o.mkv")).size();
  EXPECT_GE(frames, 1u);
  EXPECT_LE(frames, 20u);
  const auto strict = knotreel({"transcode", damaged, "-o", path("s.mkv"), "--preset", "fast", "--strict"});
  EXPECT_EQ(strict.exit_code, 3) << strict.err;
  EXPECT_FALSE(std::filesystem::exists(path("s.mkv")));
}

TEST_F(CliVideo, AFullDiskIsExit4) {
  expect_failure(knotreel({"transcode", clip_, "-o", "/dev/full", "-f", "matroska", "--preset", "fast"}), 4);
  expect_failure(knotreel({"vectorize", clip_, "-o", "/dev/full", "--preset", "fast"}), 4);
}

TEST_F(CliVideo, AfterASignalTheOutputsAreWhole) {
  const std::string longer = path("longer.mkv");
  test::write_clip(longer, 400);
  const auto expect_whole_after = [&](const test::ProcessOptions& signals) {
    const auto result = knotreel(
        {"transcode", longer, "-o", path("o.mkv"), "--preset", "fast", "--document", document_}, signals);
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_TRUE(result.err.starts_with("knotreel: interrupted")) << result.err;
    if (!std::filesystem::exists(document_)) return;  // the signal came before the first frame
    const json info = json::parse(knotreel({"info", document_, "--json"}).out);
    EXPECT_TRUE(info["complete"]);
    EXPECT_EQ(test::frame_times(path("o.mkv")).size(), info["frames"].size());
    std::filesystem::remove(document_);
  };
  expect_whole_after({.signal_once = path("clip.tcb."), .signal = SIGINT});
  // A terminal that closes is told by the system and by the shell.
  expect_whole_after({.signal_once = path("clip.tcb."),
                      .signal = SIGHUP,
                      .second_signal = SIGHUP,
                      .milliseconds_between = 3});
}

}  // namespace
}  // namespace knotreel
