// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>

#include "program.h"
#include "support/clips.h"

namespace knotreel {
namespace {

namespace fs = std::filesystem;
using test::expect_failure;
using test::expect_success;
using test::knotreel;
using test::read_text;
using test::write_text;

using Command = std::vector<std::string>;

/// A folder with a picture, a video and a document, all of which must stay as they are.
class CliDistinctPaths : public testing::Test {
 protected:
  CliDistinctPaths() {
    test::write_clip(clip_, 3);
    image::write_image(picture_, test::smooth_picture(32, 24, 3));
    expect_success(knotreel({"vectorize", picture_, "-o", document_, "--preset", "fast"}));
    fs::create_symlink("clip.mkv", path("soft.mkv"));
    fs::create_hard_link(clip_, path("hard.mkv"));
    fs::create_directory(path("folder"));
    entries_ = dir_.entries();
    for (const std::string& file : {clip_, picture_, document_}) contents_.push_back(read_text(file));
  }

  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  void expect_untouched() const {
    EXPECT_TRUE(read_text(clip_) == contents_[0]);
    EXPECT_TRUE(read_text(picture_) == contents_[1]);
    EXPECT_TRUE(read_text(document_) == contents_[2]);
  }

  /// And says why, before anything is written.
  void expect_refused(const Command& command, const std::string& why = "is the same file as") const {
    SCOPED_TRACE(testing::PrintToString(command));
    const auto result = knotreel(command);
    expect_failure(result, 2);
    EXPECT_NE(result.err.find(why), std::string::npos) << result.err;
    EXPECT_EQ(dir_.entries(), entries_);
    expect_untouched();
  }

  test::TempDir dir_;
  std::string clip_ = (dir_ / "clip.mkv").string();
  std::string picture_ = (dir_ / "picture.png").string();
  std::string document_ = (dir_ / "document.tcb").string();
  std::size_t entries_ = 0;
  std::vector<std::string> contents_;
};

TEST_F(CliDistinctPaths, NoCommandReplacesItsInput) {
  for (const Command& command :
       std::vector<Command>{{"transcode", clip_, "-o", clip_},
                            {"transcode", clip_, "-f", "null", "--document", clip_},
                            {"transcode", clip_, "-f", "null", "--stats", clip_},
                            {"transcode", clip_, "-f", "null", "--progress", clip_},
                            {"transcode", clip_, "-f", "null", "--trace", clip_},
                            {"transcode", clip_, "-f", "null", "--side-by-side", clip_},
                            {"transcode", clip_, "-f", "hash", "-o", clip_},
                            {"vectorize", clip_, "-o", clip_},
                            {"vectorize", picture_, "-o", picture_},
                            {"vectorize", picture_, "-o", path("o.tcb"), "--stats", picture_},
                            {"render", document_, "-o", document_, "--format", "png"},
                            {"render", document_, "-o", path("o.mkv"), "--stats", document_},
                            {"render", document_, "-o", clip_, "--copy-streams", clip_},
                            {"export", document_, "-o", document_, "--format", "pdf"},
                            {"dump", document_, "-o", document_},
                            {"compare", clip_, document_, "--stats", clip_},
                            {"bench", clip_, "--json", clip_},
                            {"bench", clip_, "--passthrough", clip_}}) {
    expect_refused(command);
  }
}

TEST_F(CliDistinctPaths, OtherSpellingsAndLinksAreTheSameFile) {
  for (const std::string& name : {path("soft.mkv"), path("hard.mkv"), path("folder/../clip.mkv"),
                                  path("./clip.mkv"), dir_.path().string() + "//clip.mkv"}) {
    expect_refused({"transcode", clip_, "-o", name});
    expect_refused({"transcode", name, "-o", clip_});
  }
  expect_refused({"transcode", "file://" + clip_, "-o", clip_});
}

TEST_F(CliDistinctPaths, OutputsAreNotWrittenOverEachOther) {
  const std::string same = path("same.mkv");
  for (const std::string option : {"--document", "--side-by-side", "--stats", "--progress", "--trace"}) {
    expect_refused({"transcode", clip_, "-o", same, option, same});
    expect_refused({"transcode", clip_, "-o", same, option, path("folder/../same.mkv")});
  }
  expect_refused({"vectorize", picture_, "-o", path("x"), "--stats", path("x")});
  expect_refused({"render", document_, "-o", same, "--stats", same});
  expect_refused({"render", document_, "-o", same, "--progress", path("s"), "--stats", path("s")});
}

TEST_F(CliDistinctPaths, PicturesAreToldByTheirPatterns) {
  const std::string frames = path("folder/f_%04d.png");
  expect_success(knotreel({"transcode", clip_, "-o", frames, "--preset", "fast"}));
  const std::string first = read_text(path("folder/f_0001.png"));
  expect_refused({"transcode", frames, "-o", frames});
  expect_refused({"transcode", path("folder"), "-o", frames});
  expect_refused({"transcode", path("folder/f_*.png"), "-o", path("folder/f_%04d.png")});
  expect_refused(
      {"transcode", path("folder/f_*.png"), "-o", path("x.mkv"), "--stats", path("folder/f_0002.png")});
  expect_refused({"transcode", clip_, "-o", path("n_%d.png"), "--stats", path("n_7.png")},
                 "is the same file as one of");
  expect_refused({"vectorize", clip_, "--split", path("."), "--stats", path("frame_000002.tcb")},
                 "is the same file as one of");
  EXPECT_TRUE(read_text(path("folder/f_0001.png")) == first);
  // Others in the same folder are none of its business, nor are names that only look so.
  expect_success(knotreel({"transcode", frames, "-o", path("folder/g_%04d.png"), "--preset", "fast"}));
  expect_success(knotreel({"transcode", clip_, "-f", "matroska", "-o", path("n_%d"), "--preset", "fast",
                           "--stats", path("n_7")}));
}

TEST_F(CliDistinctPaths, OutputsThatAreThereStayIfThatIsWanted) {
  const std::string there = path("there.tcb");
  const std::string frames = path("folder/f_%04d.png");
  write_text(there, "mine");
  write_text(path("folder/f_0007.png"), "mine");
  entries_ = dir_.entries();
  for (const Command& command :
       std::vector<Command>{{"vectorize", picture_, "-o", there, "-n"},
                            {"vectorize", picture_, "-o", path("o.tcb"), "--stats", there, "--no-overwrite"},
                            {"vectorize", clip_, "-o", there, "-n"},
                            {"transcode", clip_, "-o", path("o.mkv"), "--document", there, "-n"},
                            {"transcode", clip_, "-o", frames, "-n"},
                            {"render", document_, "-o", there, "--format", "png", "-n"},
                            {"render", document_, "-o", frames, "-n"},
                            {"export", document_, "-o", there, "--format", "pdf", "-n"},
                            {"copy", document_, "-o", there, "-n"}}) {
    SCOPED_TRACE(testing::PrintToString(command));
    const auto result = knotreel(command);
    expect_failure(result, 4);
    EXPECT_NE(result.err.find("is there already"), std::string::npos) << result.err;
    EXPECT_EQ(dir_.entries(), entries_);
    EXPECT_EQ(read_text(there), "mine");
    EXPECT_EQ(read_text(path("folder/f_0007.png")), "mine");
  }
  expect_success(knotreel({"render", document_, "-o", path("new.png"), "-n"}));
  expect_success(knotreel({"render", document_, "-o", "/dev/null", "--format", "png", "-n"}));
  expect_success(knotreel({"copy", document_, "-o", there}));
}

TEST_F(CliDistinctPaths, StandardOutputIsForOne) {
  for (const Command& command :
       std::vector<Command>{{"transcode", clip_, "-f", "hash", "--document", "-"},
                            {"transcode", clip_, "-f", "hash", "--stats", "-"},
                            {"transcode", clip_, "-f", "hash", "-o", "-", "--progress", "-"},
                            {"transcode", clip_, "-o", "-", "-f", "matroska", "--side-by-side", "-"},
                            {"transcode", clip_, "-o", "-", "-f", "matroska", "--document", "-"},
                            {"vectorize", clip_, "-o", "-", "--progress", "-"},
                            {"vectorize", picture_, "-o", "-", "--stats", "-"},
                            {"render", document_, "-o", "-", "-f", "matroska", "--stats", "-"},
                            {"render", document_, "-o", "-", "-f", "matroska", "--progress", "-"},
                            {"render", document_, "-f", "hash", "--stats", "-"},
                            {"render", document_, "-o", path("o.mkv"), "--stats", "-", "--progress", "-"},
                            {"bench", clip_, "--json", "-", "--markdown"},
                            {"bench", clip_, "--passthrough", "-"}}) {
    expect_refused(command, "only one output can be standard output");
  }
  // Nothing is said beside it.
  const auto stats =
      knotreel({"transcode", clip_, "-f", "hash", "-o", path("digest"), "--preset", "fast", "--stats", "-"});
  expect_success(stats);
  EXPECT_EQ(nlohmann::json::parse(stats.out)["frame_count"], 3);
  EXPECT_TRUE(read_text(path("digest")).starts_with("sha256:"));
  const auto drawn = knotreel({"render", document_, "-f", "null", "-o", "-", "--stats", "-"});
  expect_success(drawn);
  EXPECT_EQ(nlohmann::json::parse(drawn.out)["frame_count"], 1);
  const auto bench = knotreel({"bench", clip_, "--threads", "1", "--preset", "fast", "--json", "-"});
  expect_success(bench);
  EXPECT_EQ(nlohmann::json::parse(bench.out)["runs"].size(), 1u);
}

TEST_F(CliDistinctPaths, DevicesMayBeNamedOftenAndFilesReplaced) {
  expect_success(knotreel({"transcode", clip_, "-o", "/dev/null", "-f", "matroska", "--preset", "fast",
                           "--document", "/dev/null", "--stats", "/dev/null", "--progress", "/dev/null"}));
  for (int run = 0; run < 2; ++run) {
    expect_success(
        knotreel({"vectorize", picture_, "-o", path("x"), "--preset", "fast", "--stats", path("y")}));
  }
  expect_untouched();
}

TEST_F(CliDistinctPaths, ABatchReplacesNoInput) {
  fs::create_directory(path("clips"));
  const std::string clip = path("clips/clip.mp4");
  test::write_clip(clip, 3, 64, 48, "h264");
  image::write_image(path("clips/picture.png"), test::smooth_picture(32, 24, 3));
  const std::string before = read_text(clip);
  write_text(path("list.txt"), clip + "\n");
  entries_ = dir_.entries();
  expect_refused({"batch", path("clips"), "-o", path("clips"), "--transcode"});
  expect_refused({"batch", path("list.txt"), "-o", path("clips/../clips"), "--transcode"});
  expect_refused({"batch", path("list.txt"), "-o", path("out"), "--manifest", path("list.txt")});
  expect_refused({"batch", path("clips"), "-o", path("out"), "--manifest", path("out/clip.tcb")});
  expect_refused({"batch", path("clips"), "-o", path("out"), "--manifest", clip});
  EXPECT_TRUE(read_text(clip) == before);
  expect_success(knotreel({"batch", path("clips"), "-o", path("clips"), "--preset", "fast"}));
  EXPECT_TRUE(read_text(clip) == before);
}

}  // namespace
}  // namespace knotreel
