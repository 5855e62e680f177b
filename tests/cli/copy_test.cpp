// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>

#include "program.h"

namespace knotreel {
namespace {

using test::expect_failure;
using test::expect_success;
using test::read_text;
using test::TempDir;

/// A clip of four frames as a document, and the digests of its frames.
struct CopySample {
  TempDir dir;
  std::string document = path("in.tcb");

  CopySample() {
    for (int i = 0; i < 4; ++i) {
      image::Image picture = test::smooth_picture(64, 40, 3);
      for (float& sample : picture.samples) sample += float(9 * i);
      image::write_image(path("in_" + std::to_string(i) + ".png"), picture);
    }
    EXPECT_EQ(
        test::knotreel({"vectorize", path("in_%d.png"), "-o", document, "--image-rate", "10"}).exit_code, 0);
  }
  std::string path(const std::string& name) const { return (dir / name).string(); }

  /// @param part  options that choose frames.
  std::string digest(const std::string& name, std::vector<std::string> part = {}) const {
    part.insert(part.begin(), {"render", path(name), "-f", "hash"});
    const auto result = test::knotreel(part);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  }
  void copy(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "copy");
    const auto result = test::knotreel(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
  }
};

TEST(CliCopy, AWholeDocumentIsTheSameFile) {
  const CopySample sample;
  sample.copy({sample.document, "-o", sample.path("copy.tcb")});
  EXPECT_EQ(read_text(sample.path("copy.tcb")), read_text(sample.document));
  const auto piped = test::knotreel({"copy", "-", "-o", "-"}, {.input = read_text(sample.document)});
  EXPECT_EQ(piped.exit_code, 0);
  EXPECT_EQ(piped.err, "");
  EXPECT_EQ(piped.out, read_text(sample.document));
}

TEST(CliCopy, PartsShowTheSameFramesAtTheSameTimes) {
  const CopySample sample;
  sample.copy({sample.document, "-o", sample.path("frames.tcb"), "--frames", "1-2"});
  EXPECT_EQ(sample.digest("frames.tcb"), sample.digest("in.tcb", {"--frames", "1-2"}));
  sample.copy({sample.document, "-o", sample.path("times.tcb"), "--start", "0.2"});
  EXPECT_EQ(sample.digest("times.tcb"), sample.digest("in.tcb", {"--frames", "2-3"}));
}

TEST(CliCopy, SplitAndJoinedShowsTheSame) {
  const CopySample sample;
  sample.copy({sample.document, "--split", sample.path("frames")});
  sample.copy({sample.path("frames"), "-o", sample.path("folder.tcb")});
  EXPECT_EQ(sample.digest("folder.tcb"), sample.digest("in.tcb"));
  sample.copy({sample.path("frames/frame_%06d.tcb"), "-o", sample.path("pattern.tcb")});
  EXPECT_EQ(read_text(sample.path("pattern.tcb")), read_text(sample.path("folder.tcb")));
}

TEST(CliCopy, DocumentsFollowEachOther) {
  const CopySample sample;
  sample.copy({sample.document, sample.document, "-o", sample.path("twice.tcb")});
  EXPECT_EQ(sample.digest("twice.tcb", {"--frames", "4-7"}), sample.digest("in.tcb"));
  sample.copy({sample.path("twice.tcb"), "-o", sample.path("again.tcb"), "--start", "0.4"});
  EXPECT_EQ(sample.digest("again.tcb"), sample.digest("in.tcb"));
}

TEST(CliCopy, ADocumentThatWasCutShortBecomesWhole) {
  const CopySample sample;
  const std::string whole = read_text(sample.document);
  test::write_text(sample.path("cut.tcb"), whole.substr(0, whole.size() - 30));
  const auto result = test::knotreel({"copy", sample.path("cut.tcb"), "-o", sample.path("mended.tcb")});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("cut short"), std::string::npos);
  const auto info = test::knotreel({"info", sample.path("mended.tcb"), "--json"});
  EXPECT_TRUE(nlohmann::json::parse(info.out)["complete"]);
  EXPECT_EQ(sample.digest("mended.tcb"), sample.digest("in.tcb"));
}

TEST(CliCopy, WrongUsageLeavesNothing) {
  const CopySample sample;
  const std::size_t entries = sample.dir.entries();
  const std::string output = sample.path("out.tcb");
  expect_failure(test::knotreel({"copy", sample.document}), 2);
  expect_failure(test::knotreel({"copy", sample.document, "-o", sample.document}), 2);
  expect_failure(test::knotreel({"copy", sample.document, "-o", sample.path("out.mp4")}), 2);
  expect_failure(test::knotreel({"copy", sample.document, "-o", output, "--frames", "2-4"}), 2);
  expect_failure(test::knotreel({"copy", sample.document, "-o", output, "--image-rate", "0"}), 2);
  expect_failure(test::knotreel({"copy", sample.path("missing.tcb"), "-o", output}), 3);
  expect_failure(test::knotreel({"copy", sample.path("in_0.png"), "-o", output}), 3);
  expect_failure(test::knotreel({"copy", sample.path(""), "-o", sample.path("in.tcb")}), 2);
  expect_failure(test::knotreel({"copy", sample.document, "-o", sample.path("missing/out.tcb")}), 4);
  expect_failure(test::knotreel({"copy", sample.document, "-o", "/dev/full"}), 4);
  expect_failure(test::knotreel({"copy", sample.document, "--split", sample.path("in_0.png")}), 4);
  EXPECT_EQ(sample.dir.entries(), entries);
}

TEST(CliCopy, CommandsForOneDocumentTellOfItWhenGivenSeveral) {
  const CopySample sample;
  sample.copy({sample.document, "--split", sample.path("frames")});
  const auto result = test::knotreel({"render", sample.path("frames"), "-o", sample.path("out.mp4")});
  expect_failure(result, 3);
  EXPECT_NE(result.err.find("knotreel copy"), std::string::npos);
}

/// As a kill leaves it: without its end, or without its last frame.
TEST(CliCutShort, EveryCommandTellsItOnce) {
  const CopySample sample;
  const std::string cut = sample.path("cut.tcb");
  const std::string whole = read_text(sample.document);
  test::write_text(cut, whole.substr(0, whole.size() - 30));
  const std::string warning =
      "knotreel: warning: '" + cut + "' is cut short: read up to its last whole frame\n";
  const std::vector<std::vector<std::string>> commands{
      {"render", cut, "-o", sample.path("o.png"), "--frame", "1"},
      {"render", cut, "-f", "hash"},
      {"export", cut, "-o", sample.path("o.svg"), "--frame", "1"},
      {"export", cut, "-o", sample.path("o_%d.svg")},
      {"dump", cut, "-o", sample.path("o.json")},
      {"compare", sample.path("in_%d.png"), cut},
      {"compare", cut, sample.document},
      {"compare", sample.path("in_1.png"), cut, "--frame", "1"},
      {"copy", cut, "-o", sample.path("o.tcb")},
      {"copy", cut, sample.document, "-o", sample.path("two.tcb")}};
  for (const auto& command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    const auto result = test::knotreel(command);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, warning);
  }
  const auto piped = test::knotreel({"dump", "-", "-o", sample.path("o.json")}, {.input = read_text(cut)});
  EXPECT_EQ(piped.err, "knotreel: warning: standard input is cut short: read up to its last whole frame\n");
  expect_success(test::knotreel({"info", cut}));  // which has a line for it
}

TEST(CliCopy, StillsOfOneDurationHaveARate) {
  const CopySample sample;
  sample.copy({sample.document, "--split", sample.path("frames")});
  std::vector<std::string> stills;
  for (int i = 0; i < 3; ++i) {
    stills.push_back(sample.path("still" + std::to_string(i) + ".tcb"));
    expect_success(test::knotreel({"vectorize", sample.path("in_" + std::to_string(i) + ".png"), "-o",
                                   stills.back(), "--preset", "fast", "-q"}));
  }
  const auto info_of_copy = [&](std::vector<std::string> more) {
    std::vector<std::string> all = stills;
    all.insert(all.end(), more.begin(), more.end());
    all.insert(all.end(), {"-o", sample.path("film.tcb")});
    all.insert(all.begin(), "copy");
    EXPECT_EQ(test::knotreel(all).exit_code, 0);
    return nlohmann::json::parse(test::knotreel({"info", sample.path("film.tcb"), "--json"}).out);
  };
  EXPECT_EQ(info_of_copy({})["frame_rate"], (nlohmann::json{25, 1}));
  const auto film = info_of_copy({"--image-rate", "30000/1001"});
  EXPECT_EQ(film["frame_rate"], (nlohmann::json{30000, 1001}));
  EXPECT_NEAR(film["seconds"].get<double>(), 3 * 1001 / 30000.0, 1e-9);
  // One that lasts a tenth of a second beside those that last a 25th.
  EXPECT_TRUE(info_of_copy({sample.path("frames/frame_000001.tcb")})["frame_rate"].is_null());
}

TEST(CliCopy, TellsWhichFrameThereIsNot) {
  const CopySample sample;
  for (const char* command : {"copy", "render"}) {
    const auto result =
        test::knotreel({command, sample.document, "-o",
                        sample.path(command == std::string("copy") ? "a.tcb" : "a.mkv"), "--frames", "100-"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, "knotreel: there is no frame 100: the document has 4, counted from 0\n");
  }
}

}  // namespace
}  // namespace knotreel
