// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <sstream>

#include "knotreel/document/reader.h"
#include "knotreel/document/writer.h"
#include "program.h"
#include "support/clips.h"

namespace knotreel {
namespace {

namespace fs = std::filesystem;
using test::expect_success;
using test::knotreel;
using test::read_text;
using test::Sample;
using test::TempDir;
using test::write_text;

/// Turns the rest of a terminal red, sets its title, and the same with one character.
const std::string kNasty =
    "x\x1b[31m\x1b]0;t\x07\x7f\xc2\x9b"
    "31m";

void expect_printable(const std::string& text) {
  for (const char c : text) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 || c == '\n') << text;
  EXPECT_EQ(text.find('\x7f'), std::string::npos);
  EXPECT_EQ(text.find("\xc2\x9b"), std::string::npos);
  EXPECT_NE(text.find("x?[31m?]0;t???31m"), std::string::npos) << text;
}

TEST(CliLines, NamesOfFilesCannotSpeakToTheTerminal) {
  const Sample sample;
  const std::string still = sample.path(kNasty + ".tcb");
  expect_printable(knotreel({"vectorize", sample.picture, "-o", still, "--preset", "fast"}).out);
  expect_printable(knotreel({"info", still}).out);
  expect_printable(knotreel({"render", still, "-o", sample.path(kNasty + ".mkv")}).out);
  expect_printable(knotreel({"info", sample.path(kNasty + ".mkv")}).out);
  expect_printable(knotreel({"info", sample.path(kNasty)}).err);
  write_text(still, read_text(still).substr(0, fs::file_size(still) - 9));
  const auto cut = knotreel({"render", still, "-o", sample.path("o.mkv")});
  EXPECT_TRUE(cut.err.starts_with("knotreel: warning: ")) << cut.err;
  expect_printable(cut.err);
}

TEST(CliLines, NorCanWhatADocumentSaysOfItself) {
  const Sample sample;
  document::Reader reader = document::Reader::open(sample.document);
  document::SequenceInfo info = reader.info();
  info.metadata["title"] = kNasty + "\nstate           complete";
  std::ostringstream bytes;
  document::Writer writer(bytes, info);
  writer.append(reader.read(0));
  writer.finish();
  write_text(sample.path("titled.tcb"), bytes.str());
  const auto info_of = [&](const char* name) { return knotreel({"info", sample.path(name)}).out; };
  expect_printable(info_of("titled.tcb"));
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  EXPECT_EQ(lines(info_of("titled.tcb")), lines(info_of("in.tcb")) + 1);
}

/// Codecs of JPEG make standard error mute while they are at work, on whatever thread.
TEST(CliLines, WarningsOfABatchArriveWhilePicturesAreDecoded) {
  const TempDir dir;
  constexpr int kClips = 6;
  constexpr int kPicturesEach = 3;
  test::write_clip((dir / "whole.mkv").string(), 6);
  const std::string whole = read_text(dir / "whole.mkv");
  image::write_image(dir / "large.jpg", test::smooth_picture(3000, 2000, 3));
  std::string list;
  for (int i = 0; i < kClips; ++i) {
    const std::string clip = "cut" + std::to_string(i) + ".mkv";
    write_text(dir / clip, whole.substr(0, whole.size() / 2));
    list += (dir / clip).string() + "\n";
    for (int j = 0; j < kPicturesEach; ++j) {
      const std::string name = std::to_string(i) + "-" + std::to_string(j);
      fs::create_hard_link(dir / "large.jpg", dir / (name + ".jpg"));
      list += (dir / (name + ".jpg")).string() + "\n";
      // Its document cannot be written, so it is decoded and nothing else.
      fs::create_directories(dir / "out" / (name + ".tcb"));
    }
  }
  const auto result = knotreel(
      {"batch", "-", "-o", (dir / "out").string(), "--preset", "fast", "--jobs", "2"}, {.input = list});
  EXPECT_EQ(result.exit_code, 4) << result.err;
  for (int i = 0; i < kClips; ++i) {
    const std::string warning =
        "knotreel: warning: '" + (dir / ("cut" + std::to_string(i) + ".mkv")).string();
    EXPECT_NE(result.err.find(warning), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace knotreel
