// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "document/sample_models.h"
#include "knotreel/base/error.h"
#include "knotreel/document/reader.h"
#include "knotreel/document/writer.h"

namespace knotreel {
namespace {

using document::FrameModel;
using document::Reader;
using document::Writer;
using testing::difference;

constexpr std::uint64_t kRecoverySeed = 31;

std::vector<FrameModel> frames() {
  std::vector<FrameModel> result{
      testing::random_model(testing::random_mesh(96, 64, 40, 1, kRecoverySeed), 2, 3, kRecoverySeed)};
  for (std::uint64_t f = 1; f < 4; ++f) {
    result.push_back(testing::successor(result.back(), f % 2 == 0 ? 0 : 3, kRecoverySeed + f));
  }
  return result;
}

/// A folder that goes away with the test.
class Recovery : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("knotreel_recovery_" + std::to_string(getpid()));
    std::filesystem::create_directory(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path path() const { return folder_ / "clip.tcb"; }

  std::filesystem::path folder_;
};

TEST_F(Recovery, TruncatedAnywhereGivesTheWholeFrames) {
  const auto bytes = testing::write_document(frames());
  Reader whole = Reader::open(bytes);
  std::vector<FrameModel> expected;
  for (std::size_t f = 0; f < whole.frame_count(); ++f) expected.push_back(whole.read(f));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    std::size_t whole_frames = 0;
    while (whole_frames < whole.frame_count() &&
           whole.record(whole_frames).offset + whole.record(whole_frames).bytes <= length) {
      ++whole_frames;
    }
    const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
    if (whole_frames == 0) {
      try {
        Reader::open(cut);
        FAIL() << length;
      } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::kInput);
      }
      continue;
    }
    Reader reader = Reader::open(cut);
    EXPECT_FALSE(reader.complete());
    ASSERT_EQ(reader.frame_count(), whole_frames) << length;
    EXPECT_EQ(difference(reader.read(whole_frames - 1), expected[whole_frames - 1]), "");
  }
}

TEST_F(Recovery, AKilledWriterLeavesItsWholeFrames) {
  const pid_t child = fork();
  if (child == 0) {
    std::ofstream file(path(), std::ios::binary);
    Writer writer(file, testing::info_of(frames()[0]));
    for (const FrameModel& f : frames()) writer.append(f);
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  Reader reader = Reader::open(path());
  EXPECT_FALSE(reader.complete());
  EXPECT_EQ(reader.frame_count(), frames().size());
  EXPECT_NO_THROW(reader.read(frames().size() - 1));
}

TEST_F(Recovery, ADocumentCanBeReadWhileItIsWritten) {
  std::ofstream file(path(), std::ios::binary);
  Writer writer(file, testing::info_of(frames()[0]));
  EXPECT_THROW(Reader::open(path()), Error) << "no frame yet";
  std::size_t count = 0;
  for (const FrameModel& f : frames()) {
    const FrameModel stored = writer.append(f);
    Reader reader = Reader::open(path());
    EXPECT_FALSE(reader.complete());
    ASSERT_EQ(reader.frame_count(), ++count);
    EXPECT_EQ(difference(reader.read(count - 1), stored), "");
  }
  writer.finish();
  Reader reader = Reader::open(path());
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.file_bytes(), std::filesystem::file_size(path()));
  EXPECT_THROW(writer.append(frames()[0]), Error);
}

TEST_F(Recovery, AFullDiskIsAnOutputErrorAndEndsTheDocument) {
  std::ofstream full("/dev/full", std::ios::binary);
  ASSERT_TRUE(full) << "this test needs /dev/full";
  const auto kind_of = [](auto action) {
    try {
      action();
    } catch (const Error& e) {
      return e.kind();
    }
    return ErrorKind::kInternal;
  };
  EXPECT_EQ(kind_of([&] { Writer(full, testing::info_of(frames()[0])); }), ErrorKind::kOutput);

  std::ostringstream out;
  Writer writer(out, testing::info_of(frames()[0]));
  out.setstate(std::ios::badbit);
  EXPECT_EQ(kind_of([&] { writer.append(frames()[0]); }), ErrorKind::kOutput);
  out.clear();
  EXPECT_EQ(kind_of([&] { writer.append(frames()[0]); }), ErrorKind::kInvalidArgument);
}

}  // namespace
}  // namespace knotreel
