// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <thread>

#include "program.h"
#include "support/clips.h"

namespace knotreel {
namespace {

using test::expect_failure;
using test::expect_success;
using test::read_text;
using test::Sample;
using test::TempDir;
using test::write_text;

TEST(CliInput, UnreadableInputsAreExit3) {
  const Sample sample;
  const std::string picture = read_text(sample.picture);
  const std::string document = read_text(sample.document);
  write_text(sample.dir / "empty.png", "");
  write_text(sample.dir / "garbage.png", std::string(1000, 'x'));
  write_text(sample.dir / "short.png", picture.substr(0, picture.size() / 2));
  write_text(sample.dir / "empty.tcb", "");
  write_text(sample.dir / "garbage.tcb", std::string(1000, 'x'));
  for (const std::string name : {"missing.png", "empty.png", "garbage.png", "short.png", "."}) {
    SCOPED_TRACE(name);
    const std::string path = sample.path(name);
    expect_failure(test::knotreel({"vectorize", path, "-o", sample.path("out.tcb")}), 3);
    expect_failure(test::knotreel({"compare", path, sample.picture}), 3);
    expect_failure(test::knotreel({"compare", sample.document, path}), 3);
    expect_failure(test::knotreel({"info", path}), 3);
  }
  for (const std::string name : {"missing.tcb", "empty.tcb", "garbage.tcb", "in.png", "."}) {
    SCOPED_TRACE(name);
    expect_failure(test::knotreel({"render", sample.path(name), "-o", sample.path("out.png")}), 3);
    expect_failure(test::knotreel({"dump", sample.path(name)}), 3);
    if (name != "in.png") expect_failure(test::knotreel({"info", sample.path(name)}), 3);
  }
  EXPECT_EQ(sample.dir.entries(), 7u) << "no output may be left";
}

TEST(CliInput, ADocumentIsNoVideo) {
  const Sample sample;
  for (const std::string& input : {sample.document, std::string("-")}) {
    for (const std::vector<std::string>& rest :
         {std::vector<std::string>{"transcode", input, "-o", sample.path("x.mkv")},
          {"vectorize", input, "-o", sample.path("x.tcb")}}) {
      const auto result = test::knotreel(rest, {.input = input == "-" ? read_text(sample.document) : ""});
      expect_failure(result, 3);
      EXPECT_NE(result.err.find("'knotreel render' draws it"), std::string::npos) << result.err;
    }
  }
  EXPECT_EQ(sample.dir.entries(), 2u);
}

TEST(CliInput, DamagedDocumentsAreExit3OrRecoveredWhole) {
  const Sample sample(1, 24, 16);
  const std::string damaged = sample.path("damaged.tcb");
  const std::string output = sample.path("out.pgm");
  expect_success(test::knotreel({"render", sample.document, "-o", output}));
  const std::string picture = test::read_text(output);
  std::filesystem::remove(output);
  const std::string whole = test::read_text(sample.document);
  const auto write = [&](const std::string& bytes) { std::ofstream(damaged, std::ios::binary) << bytes; };

  int recovered = 0;
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 25) {
    write(whole.substr(0, size));
    const auto result = test::knotreel({"render", damaged, "-o", output});
    if (result.exit_code == 0) {  // cut behind the last frame, in the index: nothing is lost
      ++recovered;
      EXPECT_EQ(test::read_text(output), picture) << size;
      std::filesystem::remove(output);
    } else {
      test::expect_failure(result, 3);
      EXPECT_FALSE(std::filesystem::exists(output)) << size;
    }
  }
  EXPECT_LT(recovered, 13);
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 25) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (at % 8)));
    write(bytes);
    test::expect_failure(test::knotreel({"render", damaged, "-o", output}), 3);
    EXPECT_FALSE(std::filesystem::exists(output)) << at;
  }
}

TEST(CliInput, PicturesOfDifferentSizeAreExit2) {
  const TempDir dir;
  image::write_image(dir / "a.png", image::make_image(3, 4, 3));
  image::write_image(dir / "b.png", image::make_image(4, 3, 3));
  expect_failure(test::knotreel({"compare", (dir / "a.png").string(), (dir / "b.png").string()}), 2);
}

TEST(CliInput, PicturesAndDocumentsComeThroughNamedPipes) {
  const Sample sample;
  const std::string pipe = sample.path("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const auto through_pipe = [&](const std::string& input, const std::vector<std::string>& command) {
    auto writer = std::async(std::launch::async, [&] { write_text(pipe, read_text(input)); });
    const auto result = test::knotreel(command);
    ::close(::open(pipe.c_str(), O_RDONLY | O_NONBLOCK));  // a program that never came to it
    expect_success(result);
    return result.out;
  };
  through_pipe(sample.picture, {"compare", pipe, sample.picture});
  EXPECT_NE(through_pipe(sample.picture, {"info", pipe}).find("PNG"), std::string::npos);
  EXPECT_NE(through_pipe(sample.document, {"info", pipe}).find("document"), std::string::npos);
  const auto compared = through_pipe(sample.document, {"compare", sample.picture, pipe});
  EXPECT_EQ(compared, test::knotreel({"compare", sample.picture, sample.document}).out);
  EXPECT_EQ(compared, through_pipe(sample.picture, {"compare", pipe, sample.document}));
  const auto piped = test::knotreel({"compare", sample.picture, "-"}, {.input = read_text(sample.document)});
  expect_success(piped);
  EXPECT_EQ(compared, piped.out);
  through_pipe(sample.document, {"render", pipe, "-o", sample.path("a.png")});
  expect_success(test::knotreel({"render", sample.document, "-o", sample.path("b.png")}));
  EXPECT_TRUE(read_text(sample.path("a.png")) == read_text(sample.path("b.png")));
}

TEST(CliInput, OptionsWithoutEffectAreTold) {
  const Sample sample;
  const auto result =
      test::knotreel({"vectorize", sample.picture, "-o", sample.path("o.tcb"), "--no-warm-start"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err,
            "knotreel: warning: --no-warm-start is not used: '" + sample.picture + "' is one picture\n");
}

TEST(CliOutput, UnwritableOutputsAreExit4AndLeaveNothing) {
  const Sample sample;
  for (const std::string& output : {sample.path("missing/out"), std::string("/proc/out")}) {
    SCOPED_TRACE(output);
    expect_failure(test::knotreel({"render", sample.document, "-o", output + ".png"}), 4);
    expect_failure(test::knotreel({"vectorize", sample.picture, "-o", output + ".tcb"}), 4);
  }
  expect_failure(test::knotreel({"render", sample.document, "-o", sample.dir.path(), "--format", "png"}), 4);
  expect_failure(test::knotreel({"vectorize", sample.picture, "-o", sample.dir.path()}), 4);
  EXPECT_EQ(sample.dir.entries(), 2u);
}

TEST(CliOutput, AFullDiskIsExit4) {
  const Sample sample;
  for (const std::string format : {"png", "ppm", "pam", "jpg"}) {
    SCOPED_TRACE(format);
    expect_failure(test::knotreel({"render", sample.document, "-o", "/dev/full", "--format", format}), 4);
    expect_failure(test::knotreel({"render", sample.document, "-o", "-", "--format", format},
                                  {.output_file = "/dev/full"}),
                   4);
  }
  const std::vector<std::vector<std::string>> commands{{"--help"},
                                                       {"--version"},
                                                       {"info", sample.document},
                                                       {"dump", sample.document},
                                                       {"compare", sample.picture, sample.document}};
  for (const auto& command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    expect_failure(test::knotreel(command, {.output_file = "/dev/full"}), 4);
  }
}

TEST(CliOutput, AClosedPipeIsExit4WithoutAWord) {
  const Sample sample;
  const auto result =
      test::knotreel({"render", sample.document, "-o", "-", "--format", "ppm", "--size", "2000x2000"},
                     {.close_output_after = 1000});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_EQ(result.err, "");
}

TEST(CliOutput, AFifoIsOpenedOnce) {
  const Sample sample;
  const std::string fifo = sample.path("fifo");
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  const auto run_into = [&](const std::vector<std::string>& command) {
    auto reader = std::async(std::launch::async, [&] { return read_text(fifo); });
    expect_success(test::knotreel(command));
    ::close(::open(fifo.c_str(), O_WRONLY | O_NONBLOCK));  // a program that never came to it
    return reader.get();
  };
  EXPECT_TRUE(run_into({"vectorize", sample.picture, "-o", fifo}) == read_text(sample.document));
  const std::string stats =
      run_into({"vectorize", sample.picture, "-o", sample.path("other.tcb"), "--stats", fifo});
  EXPECT_EQ(nlohmann::json::parse(stats)["file_bytes"], read_text(sample.document).size());
}

TEST(CliOutput, AFailureKeepsTheOldFile) {
  const Sample sample;
  write_text(sample.dir / "out.png", "old");
  expect_failure(test::knotreel({"render", sample.path("missing.tcb"), "-o", sample.path("out.png")}), 3);
  expect_failure(test::knotreel({"render", sample.document, "-o", sample.path("out.png"), "--frame", "9"}),
                 2);
  EXPECT_EQ(read_text(sample.dir / "out.png"), "old");
}

TEST(CliInterrupt, IsExit130AndTheOutputIsRemoved) {
  const Sample sample;
  for (const int signal : {SIGINT, SIGTERM}) {
    // Large enough for many seconds; the signal comes as soon as the output has been opened.
    const auto result =
        test::knotreel({"render", sample.document, "-o", sample.path("out.png"), "--size", "40000x40000"},
                       {.signal_once = sample.dir / "out.png", .signal = signal});
    expect_failure(result, 130);
    EXPECT_EQ(sample.dir.entries(), 2u);
  }
}

TEST(CliInterrupt, ASecondSignalOfAnotherKindEndsTheProgramAtOnce) {
  const Sample sample;
  test::write_clip(sample.path("clip.mkv"), 3);
  const std::string nobody_reads = sample.path("fifo");
  ASSERT_EQ(::mkfifo(nobody_reads.c_str(), 0600), 0);
  for (const int second : {SIGTERM, SIGINT}) {
    // It waits for a reader when the first signal comes, and goes on waiting.
    const auto result = test::knotreel({"transcode", sample.path("clip.mkv"), "-f", "null", "--progress",
                                        sample.path("progress"), "--stats", nobody_reads},
                                       {.signal_once = sample.path("progress"),
                                        .signal = second == SIGINT ? SIGTERM : SIGINT,
                                        .second_signal = second});
    EXPECT_EQ(result.exit_code, 128 + second);
    std::filesystem::remove(sample.path("progress"));
  }
}

TEST(CliInterrupt, AWriterThatTakesItsTimeIsNotWaitedFor) {
  const Sample sample;
  for (const std::string input : {"", "\x89PNG"}) {
    const auto result = test::knotreel(
        {"vectorize", "-", "-o", sample.path("out.tcb")},
        {.input = input, .keep_input_open = true, .signal_once = sample.picture, .signal = SIGINT});
    expect_failure(result, 130);
  }
  const std::string nobody_writes = sample.path("pipe");
  ASSERT_EQ(::mkfifo(nobody_writes.c_str(), 0600), 0);
  const std::vector<std::vector<std::string>> commands{
      {"render", "-", "-o", sample.path("out.png")},
      {"render", nobody_writes, "-o", sample.path("out.png")},
      {"info", nobody_writes},
      {"compare", nobody_writes, sample.picture}};
  for (const auto& command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    expect_failure(
        test::knotreel(
            command,
            {.input = "\x89TCB", .keep_input_open = true, .signal_once = sample.picture, .signal = SIGINT}),
        130);
  }
}

}  // namespace
}  // namespace knotreel
