#include <filesystem>

#include "program.h"

namespace knotreel {
namespace {

using test::expect_failure;
using test::expect_success;
using test::read_text;
using test::Sample;

TEST(CliExport, WritesPdfAndSvgByTheNameOfTheOutput) {
  const Sample sample;
  expect_success(test::knotreel({"export", sample.document, "-o", sample.path("x.pdf")}));
  expect_success(test::knotreel({"export", sample.document, "-o", sample.path("x.SVG")}));
  EXPECT_TRUE(read_text(sample.path("x.pdf")).starts_with("%PDF-"));
  EXPECT_TRUE(read_text(sample.path("x.SVG")).starts_with("<?xml"));
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

}  // namespace
}  // namespace knotreel
