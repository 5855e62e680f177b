// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>

#include "program.h"

namespace knotreel {
namespace {

using test::expect_failure;
using test::expect_success;
using test::read_text;
using test::Sample;
using test::TempDir;

TEST(CliExport, WritesPdfAndSvgByTheNameOfTheOutput) {
  const Sample sample;
  expect_success(test::knotreel({"export", sample.document, "-o", sample.path("x.pdf")}));
  expect_success(test::knotreel({"export", sample.document, "-o", sample.path("x.SVG")}));
  EXPECT_TRUE(read_text(sample.path("x.pdf")).starts_with("%PDF-"));
  EXPECT_TRUE(read_text(sample.path("x.SVG")).starts_with("<?xml"));
}

/// A picture becomes a drawing at once, the same as by way of its document.
TEST(CliExport, IsWhatVectorizeWritesUnderTheNameOfADrawing) {
  const Sample sample;
  expect_success(test::knotreel({"vectorize", sample.picture, "-o", sample.path("y.tcb")}));
  for (const std::string extension : {".svg", ".PDF"}) {
    const std::string stats = sample.path("stats.json");
    expect_success(test::knotreel({"export", sample.path("y.tcb"), "-o", sample.path("a" + extension)}));
    const auto result =
        test::knotreel({"vectorize", sample.picture, "-o", sample.path("b" + extension), "--stats", stats});
    expect_success(result);
    const std::string drawing = read_text(sample.path("b" + extension));
    EXPECT_EQ(drawing, read_text(sample.path("a" + extension)));
    const std::string bytes = std::to_string(drawing.size());
    EXPECT_NE(result.out.find(bytes + " bytes"), std::string::npos) << result.out;
    EXPECT_NE(read_text(stats).find("\"file_bytes\": " + bytes), std::string::npos);
  }
}

TEST(CliExport, StandardInputAndOutputGiveTheSameBytes) {
  const Sample sample;
  expect_success(test::knotreel({"export", sample.document, "-o", sample.path("x.pdf")}));
  const auto result = test::knotreel({"export", "-", "-o", "-", "--format", "pdf", "--threads", "1"},
                                     {.input = read_text(sample.document)});
  expect_success(result);
  EXPECT_EQ(result.out, read_text(sample.path("x.pdf")));
}

TEST(CliExport, WrongValuesAreExit2AndLeaveNothing) {
  const Sample sample;
  const std::vector<std::vector<std::string>> cases{{"--scale", "0"},
                                                    {"--scale", "nan"},
                                                    {"--frame", "1"},
                                                    {"--colour-tolerance", "0"},
                                                    {"--geometry-tolerance", "1e9"},
                                                    {"--max-triangles", "3"}};
  for (std::vector<std::string> arguments : cases) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    for (const std::string name : {"x.pdf", "x.svg"}) {
      std::vector<std::string> all{"export", sample.document, "-o", sample.path(name)};
      all.insert(all.end(), arguments.begin(), arguments.end());
      expect_failure(test::knotreel(all), 2);
    }
  }
  EXPECT_EQ(sample.dir.entries(), 2u);
}

TEST(CliExport, UnreadableAndDamagedDocumentsAreExit3AndLeaveNothing) {
  const Sample sample(1, 24, 16);
  const std::string damaged = sample.path("damaged.tcb");
  const std::string whole = read_text(sample.document);
  for (const std::string name : {"x.pdf", "x.svg"}) {
    const std::string output = sample.path(name);
    expect_failure(test::knotreel({"export", sample.path("missing.tcb"), "-o", output}), 3);
    expect_failure(test::knotreel({"export", sample.picture, "-o", output}), 3);
    for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 20) {
      std::string bytes = whole;
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << (at % 8)));
      test::write_text(damaged, bytes);
      expect_failure(test::knotreel({"export", damaged, "-o", output}), 3);
      test::write_text(damaged, whole.substr(0, at / 2));
      expect_failure(test::knotreel({"export", damaged, "-o", output}), 3);
      EXPECT_FALSE(std::filesystem::exists(output)) << at;
    }
  }
  EXPECT_EQ(sample.dir.entries(), 3u);
}

TEST(CliExport, UnwritableOutputsAreExit4) {
  const Sample sample;
  expect_failure(test::knotreel({"export", sample.document, "-o", sample.path("missing/x.pdf")}), 4);
  for (const std::string format : {"pdf", "svg"}) {
    expect_failure(test::knotreel({"export", sample.document, "-o", "/dev/full", "--format", format}), 4);
  }
}

/// A document of four frames, and the folder that it is in.
struct Sequence {
  TempDir dir;
  std::string document = (dir / "clip.tcb").string();

  Sequence() {
    for (int i = 1; i <= 4; ++i) {
      image::Image picture = test::smooth_picture(36, 20, 3);
      for (float& sample : picture.samples) sample += float(3 * i);
      image::write_image(dir / ("in" + std::to_string(i) + ".png"), picture);
    }
    expect_success(test::knotreel({"vectorize", (dir / "in%d.png").string(), "-o", document}));
  }
  std::string path(const std::string& name) const { return (dir / name).string(); }
  test::ProcessResult exported(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"export", document});
    return test::knotreel(arguments);
  }
};

TEST(CliExport, APatternMeansAllFramesOfASequence) {
  const Sequence sequence;
  expect_success(sequence.exported({"-o", sequence.path("f_%02d.svg")}));
  for (int i = 1; i <= 4; ++i) {
    const std::string alone = sequence.path("alone.svg");
    expect_success(sequence.exported({"-o", alone, "--frame", std::to_string(i - 1)}));
    EXPECT_TRUE(read_text(sequence.path("f_0" + std::to_string(i) + ".svg")) == read_text(alone)) << i;
  }
  EXPECT_FALSE(std::filesystem::exists(sequence.path("f_05.svg")));
}

TEST(CliExport, APartOfASequenceIsNumberedFromOne) {
  const Sequence sequence;
  expect_success(sequence.exported({"-o", sequence.path("f_%d.pdf"), "--frames", "1-2"}));
  expect_success(sequence.exported({"-o", sequence.path("g_%d.pdf"), "--start", "0.04", "--end", "0.12"}));
  expect_success(sequence.exported({"-o", sequence.path("alone.pdf"), "--frame", "1"}));
  for (const char* name : {"f_1.pdf", "g_1.pdf"}) {
    EXPECT_TRUE(read_text(sequence.path(name)) == read_text(sequence.path("alone.pdf"))) << name;
  }
  for (const char* name : {"f_2.pdf", "g_2.pdf"}) EXPECT_TRUE(std::filesystem::exists(sequence.path(name)));
  for (const char* name : {"f_3.pdf", "g_3.pdf"}) EXPECT_FALSE(std::filesystem::exists(sequence.path(name)));
}

TEST(CliExport, OptionsForSequencesAndForOneFrameDoNotMix) {
  const Sequence sequence;
  const std::size_t before = sequence.dir.entries();
  expect_failure(sequence.exported({"-o", sequence.path("x.svg"), "--frames", "0-1"}), 2);
  expect_failure(sequence.exported({"-o", sequence.path("x.svg"), "--end", "1"}), 2);
  expect_failure(sequence.exported({"-o", sequence.path("x%d.svg"), "--frame", "1"}), 2);
  expect_failure(sequence.exported({"-o", sequence.path("x%d.svg"), "--frames", "2-4"}), 2);
  expect_failure(sequence.exported({"-o", sequence.path("x%d.svg"), "--start", "9"}), 2);
  EXPECT_EQ(sequence.dir.entries(), before);
}

}  // namespace
}  // namespace knotreel
