// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <span>
#include <thread>

#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/base/output_file.h"
#include "support/temp_dir.h"

namespace knotreel {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::TempDir;
using test::write_text;

ErrorKind kind_of(const auto& action) {
  try {
    action();
  } catch (const Error& e) {
    return e.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::kInternal;
}

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const TempDir dir;
  OutputFile file(dir / "a.txt");
  file.write("one ");
  EXPECT_FALSE(fs::exists(dir / "a.txt"));
  file.write("two");
  file.commit();
  EXPECT_EQ(read_text(dir / "a.txt"), "one two");
  EXPECT_EQ(dir.entries(), 1u);
}

TEST(OutputFile, UncommittedLeavesTheOldFileAndNothingElse) {
  const TempDir dir;
  write_text(dir / "a.txt", "old");
  { OutputFile(dir / "a.txt").write("new"); }
  EXPECT_EQ(read_text(dir / "a.txt"), "old");
  EXPECT_EQ(dir.entries(), 1u);
}

TEST(OutputFile, ReplacesWhatALinkPointsTo) {
  const TempDir dir;
  write_text(dir / "real.txt", "old");
  fs::create_symlink("real.txt", dir / "link.txt");
  OutputFile file(dir / "link.txt");
  file.write("new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(dir / "link.txt"));
  EXPECT_EQ(read_text(dir / "real.txt"), "new");
}

TEST(OutputFile, MakesWhatALinkPointsTo) {
  const TempDir dir;
  fs::create_directory(dir / "there");
  fs::create_symlink("there/second", dir / "first");
  fs::create_symlink("real.txt", dir / "there/second");
  OutputFile file(dir / "first");
  file.write("new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(dir / "first"));
  EXPECT_EQ(read_text(dir / "there/real.txt"), "new");
  fs::create_symlink("circle", dir / "circle");
  EXPECT_THROW(OutputFile(dir / "circle"), Error);
  EXPECT_EQ(dir.entries(), 3u);
}

TEST(OutputFile, KeepsTheModeOfWhatItReplaces) {
  const TempDir dir;
  for (const auto mode : {fs::perms(0600), fs::perms(0666), fs::perms(0444)}) {
    write_text(dir / "a.txt", "old");
    fs::permissions(dir / "a.txt", mode);
    OutputFile file(dir / "a.txt");
    file.write("new");
    file.commit();
    EXPECT_EQ(read_text(dir / "a.txt"), "new");
    EXPECT_EQ(fs::status(dir / "a.txt").permissions(), mode);
    fs::remove(dir / "a.txt");
  }
}

TEST(OutputFile, TwoOfOneNameDoNotMix) {
  const TempDir dir;
  OutputFile first(dir / "a.txt");
  first.write("first");
  first.flush();
  OutputFile second(dir / "." / "a.txt");
  second.write("2nd");
  EXPECT_EQ(dir.entries(), 2u);
  second.commit();
  EXPECT_EQ(read_text(dir / "a.txt"), "2nd");
  first.commit();
  EXPECT_EQ(read_text(dir / "a.txt"), "first");
  EXPECT_EQ(dir.entries(), 1u);
}

/// Process ids come again, in containers soon.
TEST(OutputFile, APartOfADeadProcessIsReplaced) {
  const TempDir dir;
  write_text(dir / "precious.txt", "untouched");
  const auto part = [&] {  // the only other file
    for (const auto& entry : fs::directory_iterator(dir.path())) {
      if (entry.path().extension() == ".part") return entry.path().string();
    }
    return std::string();
  };
  std::string name;
  {
    const OutputFile file(dir / "a");
    name = part();
  }
  const std::string before = "." + std::to_string(::getpid()) + ".";
  const std::size_t at = name.find(before) + before.size();
  // Names are numbered: these are of the next objects, whether the first was the first of the process or not.
  const int number = name.substr(at) == "part" ? 1 : std::stoi(name.substr(at));
  fs::create_symlink("precious.txt", name.substr(0, at) + std::to_string(number + 1) + ".part");
  OutputFile file(dir / "a");
  file.write("new");
  file.commit();
  EXPECT_EQ(read_text(dir / "a"), "new");
  EXPECT_EQ(read_text(dir / "precious.txt"), "untouched");
  EXPECT_EQ(dir.entries(), 2u);
}

TEST(OutputFile, LargeAndPlacedWritesKeepTheirOrder) {
  const TempDir dir;
  std::string expected;
  {
    OutputFile file(dir / "big");
    for (int i = 0; i < 50; ++i) {
      const std::string piece(std::size_t(1 + i * 2000), char('a' + i % 26));
      file.write(piece);
      expected += piece;
    }
    EXPECT_EQ(file.size(), expected.size());
    file.write_at(10'000'000, std::as_bytes(std::span("z", 1)));
    file.commit();
  }
  expected.resize(10'000'000, '\0');
  EXPECT_EQ(read_text(dir / "big"), expected + "z");
}

TEST(OutputFile, FailuresAreOutputErrors) {
  const TempDir dir;
  EXPECT_EQ(kind_of([&] { OutputFile(dir / "missing/a.txt"); }), ErrorKind::kOutput);
  EXPECT_EQ(kind_of([&] { OutputFile(dir.path()); }), ErrorKind::kOutput);
  EXPECT_EQ(kind_of([&] {
              OutputFile file("/dev/full");
              file.write("x");
              file.commit();
            }),
            ErrorKind::kOutput);
  EXPECT_EQ(dir.entries(), 0u);
}

TEST(OutputFile, APipeWithoutReaderIsABrokenPipe) {
  const TempDir dir;
  ::signal(SIGPIPE, SIG_IGN);
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const std::string name = "/dev/fd/" + std::to_string(ends[1]);
  OutputFile file(name);
  ::close(ends[0]);
  file.write("x");
  EXPECT_THROW(file.commit(), BrokenPipe);
  ::close(ends[1]);
}

TEST(InputFile, ReadsWhatIsThere) {
  const TempDir dir;
  for (const std::size_t size : {0u, 1u, 65536u, 1000000u}) {
    const std::string text(size, 'q');
    write_text(dir / "in", text);
    const auto bytes = read_whole(dir / "in", 1 << 20);
    EXPECT_TRUE(std::ranges::equal(bytes, std::as_bytes(std::span(text))));
    EXPECT_EQ(read_start(dir / "in", 10).size(), std::min<std::size_t>(size, 10));
  }
}

TEST(InputFile, TakesNoMoreOfAPipeThanIsAccepted) {
  const TempDir dir;
  const std::string pipe = (dir / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  ::signal(SIGPIPE, SIG_IGN);
  std::size_t written = 0;
  std::thread writer([&] {
    const int descriptor = ::open(pipe.c_str(), O_WRONLY);
    const std::vector<char> block(1 << 12);
    for (ssize_t done = 1; done > 0; written += static_cast<std::size_t>(std::max<ssize_t>(done, 0)))
      done = ::write(descriptor, block.data(), block.size());
    ::close(descriptor);
  });
  constexpr std::size_t kAccepted = 2'200'000;
  EXPECT_EQ(kind_of([&] { read_whole(pipe, kAccepted); }), ErrorKind::kInput);
  writer.join();
  EXPECT_LT(written, kAccepted + (1 << 18)) << "what the pipe itself holds comes on top";
}

TEST(InputFile, FailuresAreInputErrors) {
  const TempDir dir;
  write_text(dir / "in", "12345");
  EXPECT_EQ(kind_of([&] { read_whole(dir / "missing", 100); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([&] { read_start(dir / "missing", 100); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([&] { read_whole(dir.path(), 100); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([&] { read_whole(dir / "in", 4); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([&] { read_whole("/dev/zero", 1 << 20); }), ErrorKind::kInput)
      << "must not read on for ever";
  EXPECT_EQ(read_whole(dir / "in", 5).size(), 5u);
}

}  // namespace
}  // namespace knotreel
