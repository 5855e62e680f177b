// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>

#include "knotreel/document/reader.h"
#include "program.h"
#include "support/clips.h"

namespace knotreel {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::knotreel;
using test::read_text;

/// A folder with a small video and its document.
class CliRobustness : public testing::Test {
 protected:
  static constexpr int kFrames = 24;

  CliRobustness() {
    test::write_clip(clip_, kFrames);
    expect_success(knotreel({"vectorize", clip_, "-o", path("whole.tcb"), "--preset", "fast"}));
  }

  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  /// Names of the files that begin so.
  std::vector<std::string> files(const std::string& prefix) const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(dir_.path())) {
      if (entry.path().filename().string().starts_with(prefix)) found.push_back(entry.path().string());
    }
    return found;
  }

  test::TempDir dir_;
  std::string clip_ = (dir_ / "clip.mkv").string();
};

/// Frames of a document whose chunks end within so many bytes.
std::size_t frames_within(const std::string& document, std::uintmax_t bytes) {
  const document::Reader reader = document::Reader::open(document);
  std::size_t count = 0;
  while (count < reader.frame_count() && reader.record(count).offset + reader.record(count).bytes <= bytes) {
    ++count;
  }
  return count;
}

TEST_F(CliRobustness, AfterAKillTheDocumentOpensUpToItsLastWholeFrame) {
  const std::string whole = read_text(path("whole.tcb"));
  std::mt19937 random(20261121);
  std::size_t most = 0;
  for (int kill = 0; kill < 6; ++kill) {
    const std::uintmax_t at = random() % (whole.size() * 3 / 4);
    SCOPED_TRACE("killed at " + std::to_string(at) + " of " + std::to_string(whole.size()) + " bytes");
    const auto killed = knotreel({"vectorize", clip_, "-o", path("cut.tcb"), "--preset", "fast"},
                                 {.signal_once = path("cut.tcb."), .signal_at_bytes = at, .signal = SIGKILL});
    ASSERT_EQ(killed.exit_code, 128 + SIGKILL);
    EXPECT_FALSE(fs::exists(path("cut.tcb")));
    ASSERT_EQ(files("cut.tcb.").size(), 1u);
    const std::string part = files("cut.tcb.")[0];
    const std::string left = read_text(part);
    EXPECT_GE(left.size(), at) << "frames are in the file as soon as they are made";
    EXPECT_TRUE(whole.starts_with(left));
    const std::size_t frames = frames_within(path("whole.tcb"), left.size());
    most = std::max(most, frames);
    if (frames == 0) {
      expect_failure(knotreel({"info", part}), 3);
    } else {
      const auto info = knotreel({"info", part, "--json"});
      expect_success(info);
      EXPECT_EQ(json::parse(info.out)["frame_count"], frames);
      EXPECT_FALSE(json::parse(info.out)["complete"]);
      const auto render = knotreel({"render", part, "-o", path("cut.mkv"), "--codec", "ffv1"});
      EXPECT_EQ(render.exit_code, 0) << render.err;
      EXPECT_EQ(render.err,
                "knotreel: warning: '" + part + "' is cut short: read up to its last whole frame\n");
      EXPECT_EQ(test::frame_times(path("cut.mkv")).size(), frames);
    }
    fs::remove(part);
  }
  EXPECT_GT(most, 2u) << "no kill came late enough";
}

TEST_F(CliRobustness, AFullDiskIsToldAndDamagesNothing) {
  const std::string document = path("whole.tcb");
  const std::string picture = path("picture.png");
  image::write_image(picture, test::sharp_picture(64, 48, 3));
  const std::vector<std::vector<std::string>> commands{
      {"vectorize", clip_, "-o", path("old.tcb"), "--preset", "fast"},
      {"vectorize", picture, "-o", path("old.tcb"), "--preset", "fast"},
      {"transcode", clip_, "-o", path("old.mkv"), "--preset", "fast"},
      {"transcode", clip_, "-o", path("old.mp4"), "--preset", "fast", "--document", path("old.tcb")},
      {"transcode", clip_, "-o", path("old.mp4"), "--preset", "fast", "--stats", path("old.json")},
      {"render", document, "-o", path("old.mkv"), "--codec", "ffv1"},
      {"render", document, "-o", path("old.png"), "--scale", "4", "--frame", "0"},
      {"export", document, "-o", path("old.pdf"), "--frame", "0"}};
  for (const char* name : {"old.tcb", "old.mkv", "old.mp4", "old.json", "old.png", "old.pdf"}) {
    std::ofstream(path(name)) << "old";
  }
  const std::size_t entries = dir_.entries();
  for (const auto& command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    expect_failure(knotreel(command, {.max_file_bytes = 600}), 4);
    EXPECT_EQ(dir_.entries(), entries);
    for (const std::string& file : files("old.")) EXPECT_EQ(read_text(file), "old") << file;
  }
}

TEST_F(CliRobustness, InputsThatAreNoneAreExit3InOneLine) {
  std::ofstream(path("empty.mp4")) << "";
  std::ofstream(path("text.mkv")) << "no video at all\n";
  std::ofstream(path("sound.wav")) << "RIFF";
  std::ofstream(path("wrong.tcb")) << read_text(clip_);
  fs::create_directory(path("nothing"));
  for (const char* name : {"empty.mp4", "text.mkv", "sound.wav", "missing.mkv", "nothing"}) {
    SCOPED_TRACE(name);
    expect_failure(knotreel({"transcode", path(name), "-o", path("o.mkv")}), 3);
    expect_failure(knotreel({"vectorize", path(name), "-o", path("o.tcb")}), 3);
    expect_failure(knotreel({"info", path(name)}), 3);
  }
  for (const char* name : {"wrong.tcb", "empty.mp4", "clip.mkv"}) {
    SCOPED_TRACE(name);
    expect_failure(knotreel({"render", path(name), "-o", path("o.mkv")}), 3);
  }
  EXPECT_TRUE(files("o.").empty());
}

/// Cut and damaged videos give what can be decoded, and with --strict nothing.
TEST_F(CliRobustness, WhatCanBeDecodedIsWrittenUnlessStrict) {
  const std::string whole = read_text(clip_);
  std::string damaged = whole;
  damaged[damaged.size() / 2] ^= 0x10;
  std::ofstream(path("cut.mkv")) << whole.substr(0, whole.size() / 2);
  std::ofstream(path("hurt.mkv")) << damaged;
  for (const std::string name : {"cut.mkv", "hurt.mkv"}) {
    SCOPED_TRACE(name);
    const auto result = knotreel({"vectorize", path(name), "-o", path("o.tcb"), "--preset", "fast"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(result.err.starts_with("knotreel: warning: ")) << result.err;
    const std::size_t frames = document::Reader::open(path("o.tcb")).frame_count();
    EXPECT_GE(frames, std::size_t(kFrames) / 3);
    EXPECT_LE(frames, std::size_t(kFrames));
    fs::remove(path("o.tcb"));
    expect_failure(knotreel({"vectorize", path(name), "-o", path("o.tcb"), "--preset", "fast", "--strict"}),
                   3);
    EXPECT_TRUE(files("o.tcb").empty());
  }
}

}  // namespace
}  // namespace knotreel
