// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <utility>

#include "program.h"

namespace knotreel {
namespace {

using test::expect_failure;
using test::expect_success;
using test::Sample;

/// Codecs of pictures come with eighty libraries: see docs/decisions/0028-codecs-on-demand.md.
TEST(Cli, CodecsOfPicturesAreNotLoadedForNothing) {
  const auto loaded = test::run({"/usr/bin/env", "LD_TRACE_LOADED_OBJECTS=1", KNOTREEL_PROGRAM});
  EXPECT_NE(loaded.out.find("libavcodec"), std::string::npos) << loaded.out << loaded.err;
  EXPECT_EQ(loaded.out.find("imgcodecs"), std::string::npos);
}

TEST(Cli, HelpIsAnAnswerAndTellsTheExitCodes) {
  const auto result = test::knotreel({"--help"});
  expect_success(result);
  for (const char* text : {"vectorize", "transcode", "render", "export", "info", "dump", "compare",
                           "Examples", "130 interrupted"}) {
    EXPECT_NE(result.out.find(text), std::string::npos) << text;
  }
}

TEST(Cli, EveryCommandHasHelpWithAnExample) {
  for (const std::string command :
       {"vectorize", "transcode", "batch", "render", "export", "copy", "info", "dump", "compare", "bench"}) {
    const auto result = test::knotreel({command, "--help"});
    expect_success(result);
    EXPECT_NE(result.out.find("knotreel " + command), std::string::npos) << command;
    std::size_t longest = 0;
    for (std::size_t start = 0, end; (end = result.out.find('\n', start)) != std::string::npos;
         start = end + 1) {
      longest = std::max(longest, end - start);
    }
    EXPECT_LE(longest, 110u) << command;
  }
}

TEST(Cli, HelpTellsTheDefaultOfTheCommand) {
  const auto help = [](const char* command) { return test::knotreel({command, "--help"}).out; };
  EXPECT_NE(help("transcode").find("(default 2%, "), std::string::npos);
  EXPECT_EQ(help("transcode").find("2.75%"), std::string::npos);
  for (const char* command : {"vectorize", "batch"}) {
    const std::string text = help(command);
    EXPECT_NE(text.find("(default 2.75%, of small pictures 20% up to 3000,"), std::string::npos) << command;
    EXPECT_NE(text.find("of drawings 10% to 40%, of videos 2%,"), std::string::npos) << command;
  }
}

TEST(Cli, VersionNamesTheLibraries) {
  const auto result = test::knotreel({"--version"});
  expect_success(result);
  EXPECT_TRUE(result.out.starts_with("knotreel " KNOTREEL_VERSION " (")) << result.out;
  for (const char* library : {"OpenCV", "CGAL", "Eigen", "oneTBB", "libpng", "libtiff"}) {
    EXPECT_NE(result.out.find(library), std::string::npos) << library;
  }
}

TEST(Cli, NoDocumentIsCalledAsADrawingOrAVideo) {
  const Sample sample;
  for (const auto& [name, command] :
       {std::pair{"x.svg", "export"}, {"x.PDF", "export"}, {"x.png", "render"}, {"x.mp4", "render"}}) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"vectorize", sample.picture, "-o"},
          {"transcode", sample.picture, "-o", sample.path("y.mkv"), "--document"}}) {
      if (command == std::string("export") && arguments[0] == "vectorize") continue;  // one picture may be
      std::vector<std::string> all = arguments;
      all.push_back(sample.path(name));
      const auto result = test::knotreel(all);
      expect_failure(result, 2);
      EXPECT_NE(result.err.find(std::string("'") + command + " x.tcb -o "), std::string::npos) << result.err;
      EXPECT_FALSE(std::filesystem::exists(sample.path(name)));
    }
  }
}

TEST(Cli, WrongUsageNamesTheHelpOfTheCommand) {
  const auto error = [](std::vector<std::string> arguments) { return test::knotreel(arguments).err; };
  EXPECT_NE(error({"--bogus"}).find("(see knotreel --help)"), std::string::npos);
  EXPECT_NE(error({"render"}).find("(see knotreel render --help)"), std::string::npos);
  EXPECT_NE(error({"compare", "x", "y", "--bogus"}).find("(see knotreel compare --help)"), std::string::npos);
}

TEST(Cli, SlipsOfTheFingersAreGuessed) {
  const auto message = [](const std::vector<std::string>& arguments) {
    const auto result = test::knotreel(arguments);
    expect_failure(result, 2);
    return result.err;
  };
  EXPECT_EQ(message({"vectorise", "a.png"}),
            "knotreel: there is no command 'vectorise'; did you mean 'vectorize'? (see knotreel --help)\n");
  EXPECT_EQ(message({"render", "a.tcb", "--sacle", "2"}),
            "knotreel: there is no option '--sacle'; did you mean '--scale'? (see knotreel render --help)\n");
  EXPECT_EQ(
      message({"transcode", "a.mp4", "--scael=2"}),
      "knotreel: there is no option '--scael'; did you mean '--scale'? (see knotreel transcode --help)\n");
  EXPECT_EQ(message({"transcode", "a.mp4", "--frobnicate"}),
            "knotreel: there is no option '--frobnicate' (see knotreel transcode --help)\n");
  EXPECT_EQ(message({"frobnicate"}), "knotreel: there is no command 'frobnicate' (see knotreel --help)\n");
  EXPECT_EQ(message({std::string(100000, 'x')}).find("mean"), std::string::npos);
}

TEST(Cli, HelpIsACommandToo) {
  const auto same = [](const std::vector<std::string>& a, const std::vector<std::string>& b) {
    const auto said = test::knotreel(a);
    EXPECT_EQ(said.exit_code, 0);
    EXPECT_EQ(said.out, test::knotreel(b).out);
    EXPECT_EQ(said.err, "");
  };
  same({"help"}, {"--help"});
  same({"help", "render"}, {"render", "--help"});
  const auto unknown = test::knotreel({"help", "rendre"});
  expect_failure(unknown, 2);
  EXPECT_EQ(unknown.err,
            "knotreel: there is no command 'rendre'; did you mean 'render'? (see knotreel --help)\n");
}

TEST(Cli, ArgumentsTooManyAreNamed) {
  const auto two = test::knotreel({"render", "a.tcb", "b.png"});
  expect_failure(two, 2);
  EXPECT_EQ(two.err,
            "knotreel: 'b.png' is one argument too many; -o names the output (see knotreel render --help)\n");
  const auto three = test::knotreel({"vectorize", "a.png", "b.png", "-o", "c.tcb"});
  expect_failure(three, 2);
  EXPECT_EQ(three.err, "knotreel: 'b.png' is one argument too many (see knotreel vectorize --help)\n");
}

TEST(Cli, WrongUsageIsExit2) {
  const std::vector<std::vector<std::string>> cases{
      {},
      {"frobnicate"},
      {"--bogus"},
      {"render"},
      {"render", "x.tcb"},
      {"render", "x.tcb", "-o", "x.png", "--scale", "2", "--size", "3x3"},
      {"render", "x.tcb", "-o", "x.png", "--depth", "9"},
      {"render", "x.tcb", "-o", "x.png", "--frame", "-1"},
      {"render", "x.tcb", "-o", "x.png", "--threads", "-1"},
      {"render", "x.tcb", "-o", "x.png", "--background", "mauve"},
      {"render", "x.tcb", "-o", "x.png", "--background", "1,2,256"},
      {"render", "x.tcb", "-o", "x.png", "--background", "#12345g"},
      {"render", "x.tcb", "-o", "x.png", "--format", "docx"},
      {"compare", "x.png"},
      {"compare", "x.tcb", "y.tcb", "--frame", "-1"},
      {"export", "x.tcb"},
      {"export", "x.tcb", "-o", "x.png"},
      {"export", "x.tcb", "-o", "x.pdf", "--format", "eps"},
      {"export", "x.tcb", "-o", "x.pdf", "--max-triangles", "0"},
      {"vectorize", "x.png"},
      {"transcode", "x.mp4"},
      {"transcode", "x.mp4", "-o", "y.mp4", "--temporal-weight", "2"},
      {"transcode", "x.mp4", "-o", "y.mp4", "--temporal-weight", "nan"},
      {"transcode", "x.mp4", "-o", "y.mp4", "--scene-threshold", "nan"},
      {"transcode", "x.mp4", "-o", "y.mp4", "--crf", "nan"},
      {"batch", "x", "-o", "y", "--alone-above", "nan"},
      {"bench", "--threshold", "nan", "--compare", "x", "y"},
      {"transcode", "x.mp4", "-o", "y.mp4", "--image-rate", "fast"},
  };
  for (const auto& arguments : cases) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    expect_failure(test::knotreel(arguments), 2);
  }
}

TEST(Cli, WrongValuesForARealFileAreExit2) {
  const Sample sample;
  const std::vector<std::vector<std::string>> cases{
      {"render", "--scale", "0"},        {"render", "--scale", "nan"},
      {"render", "--scale", "1e9"},      {"render", "--size", "0x5"},
      {"render", "--size", "5"},         {"render", "--size", "5x5x5"},
      {"render", "--size", "2000000x1"}, {"render", "--crop", "1,2,3"},
      {"render", "--crop", "60,0,5,5"},  {"render", "--crop", "-1,0,5,5"},
      {"render", "--crop", "0,0,0,5"},   {"render", "--size", "1000000x1000000"},
      {"render", "--frame", "1"},        {"render", "--depth", "float"},
  };
  for (auto arguments : cases) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    arguments.insert(arguments.begin() + 1, {sample.document, "-o", sample.path("out.png")});
    expect_failure(test::knotreel(arguments), 2);
  }
  expect_failure(test::knotreel({"render", sample.document, "-o", sample.path("out.xyz")}), 2);
  EXPECT_EQ(sample.dir.entries(), 2u) << "no output may be left";
}

TEST(Cli, NamesOfOtherFilesThanPicturesTellWhoWritesThem) {
  const auto message = [](const std::string& command, const std::string& output) {
    const auto result = test::knotreel({command, "x.tcb", "-o", output});
    expect_failure(result, 2);
    return result.err;
  };
  for (const std::string command : {"render", "transcode"}) {
    EXPECT_NE(message(command, "a.svg").find("'knotreel export FILE.tcb -o a.svg'"), std::string::npos);
    EXPECT_NE(message(command, "a.PDF").find("'knotreel export FILE.tcb -o a.PDF'"), std::string::npos);
  }
  EXPECT_NE(message("render", "a.tcb").find("'knotreel copy FILE -o a.tcb'"), std::string::npos);
  EXPECT_NE(message("transcode", "a.tcb").find("'knotreel vectorize FILE -o a.tcb'"), std::string::npos);
}

/// What is wrong whatever the document says is told before it is looked for.
TEST(Cli, OptionsAreCheckedBeforeDocumentsAreRead) {
  const std::vector<std::vector<std::string>> cases{
      {"render", "-o", "x.png", "--size", "640x"},   {"render", "-o", "x.png", "--scale", "0"},
      {"render", "-o", "x.png", "--crop", "1,2"},    {"render", "-o", "x.mkv", "--fps", "0"},
      {"render", "-o", "x.mkv", "--frames", "4-1"},  {"render", "-o", "x.mkv", "--depth", "float"},
      {"export", "-o", "x.pdf", "--scale", "0"},     {"export", "-o", "x.svg", "--colour-tolerance", "0"},
      {"export", "-o", "x%d.svg", "--frames", "4-1"}};
  for (std::vector<std::string> arguments : cases) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    arguments.insert(arguments.begin() + 1, "/nonexistent/x.tcb");
    expect_failure(test::knotreel(arguments), 2);
  }
}

/// Before anything is read, or made for a name that only the second frame does not fit.
TEST(Cli, NamesWithTwoNumbersAreRefused) {
  const std::vector<std::vector<std::string>> cases{
      {"render", "-o", "x_%d_%d.png"},
      {"render", "-o", "x_%d_%04d.png", "--frames", "0-3"},
      {"export", "-o", "%d_%d_%d.svg", "--frames", "0-3"},
      {"transcode", "-o", "x_%d_%d.png"},
      {"transcode", "-o", "x.mp4", "--side-by-side", "x_%d_%d.png"}};
  for (std::vector<std::string> arguments : cases) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    arguments.insert(arguments.begin() + 1, "/nonexistent/x.tcb");
    const auto result = test::knotreel(arguments);
    expect_failure(result, 2);
    EXPECT_NE(result.err.find("has more than one number"), std::string::npos) << result.err;
  }
}

TEST(Cli, NamesWithLineBreaksStillGiveOneLine) {
  expect_failure(test::knotreel({"info", "a\nb\x1b[31m.png"}), 3);
}

}  // namespace
}  // namespace knotreel
