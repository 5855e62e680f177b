// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/document_sink.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "knotreel/base/error.h"
#include "knotreel/document/reader.h"
#include "support/models.h"
#include "support/temp_dir.h"

namespace knotreel::pipeline {
namespace {

document::FrameModel small_model(std::int64_t pts = 0) {
  document::FrameModel model = testing::blank_model(testing::MeshBuilder(16, 12).triangulated(), 2, 3);
  model.pts = pts;
  return model;
}

document::SequenceInfo small_info() {
  document::SequenceInfo info;
  info.width = 16;
  info.height = 12;
  info.channels = 3;
  info.degree = 2;
  return info;
}

/// A folder with a document of before.
class DocumentSinkTest : public ::testing::Test {
 protected:
  DocumentSinkTest() { std::ofstream(path_) << "old"; }

  /// The file that is written aside; empty if there is none.
  std::string part() const {
    for (const auto& entry : std::filesystem::directory_iterator(dir_.path())) {
      if (entry.path() != path_) return entry.path().string();
    }
    return {};
  }
  std::string text() const {
    std::string word;
    std::ifstream(path_) >> word;
    return word;
  }

  test::TempDir dir_;
  std::string path_ = (dir_ / "clip.tcb").string();
};

TEST_F(DocumentSinkTest, CanBeReadFromItsPartFileUntilItIsFinished) {
  DocumentSink sink(path_, small_info());
  for (std::size_t count = 1; count <= 3; ++count) {
    sink.append(small_model(std::int64_t(count)));
    EXPECT_EQ(document::Reader::open(part()).frame_count(), count);
  }
  EXPECT_EQ(text(), "old");
  sink.finish();
  EXPECT_EQ(part(), "");
  const document::Reader reader = document::Reader::open(path_);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.file_bytes(), sink.bytes());
}

TEST_F(DocumentSinkTest, LeavesNothingWhereItIsGivenUp) {
  { DocumentSink(path_, small_info()).append(small_model()); }
  EXPECT_EQ(text(), "old");
  EXPECT_EQ(part(), "");
}

TEST_F(DocumentSinkTest, LeavesItsWholeFramesWhereTheProgramIsKilled) {
  const pid_t child = fork();
  if (child == 0) {
    DocumentSink sink(path_, small_info());
    sink.append(small_model());
    sink.append(small_model(1));
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(text(), "old");
  EXPECT_EQ(document::Reader::open(part()).frame_count(), 2u);
}

TEST_F(DocumentSinkTest, APathThatCannotBeWrittenIsAnOutputError) {
  try {
    DocumentSink sink((dir_ / "missing/clip.tcb").string(), small_info());
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kOutput);
  }
}

}  // namespace
}  // namespace knotreel::pipeline
