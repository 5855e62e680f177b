// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "knotreel/base/output_file.h"
#include "knotreel/pipeline/job.h"

/// What a command tells of a video while it is worked on.
namespace knotreel::cli {

/// One line on a terminal that is gone afterwards; elsewhere a line every ten seconds. One thread at a time.
class VideoLine {
 public:
  /// @param frames  of the source, an estimate; 0 if unknown.
  explicit VideoLine(std::uint64_t frames);
  ~VideoLine();
  VideoLine(const VideoLine&) = delete;
  VideoLine& operator=(const VideoLine&) = delete;

  void show(const pipeline::FrameRow& row);

 private:
  bool terminal_;
  std::uint64_t frames_;
  double shown_ = 0;  ///< seconds since the start of the run
};

/// Lines `key=value` for other programs, a block per frame. One thread at a time.
class ProgressFile {
 public:
  /// @param path  `-`: standard output; empty: none. @param time_base of the rows.
  /// @throws Error{kOutput}.
  ProgressFile(const std::string& path, video::Rational time_base);
  ~ProgressFile();
  ProgressFile(const ProgressFile&) = delete;
  ProgressFile& operator=(const ProgressFile&) = delete;

  void show(const pipeline::FrameRow& row);
  /// The last block, with progress=end.
  void end();

 private:
  void write(const std::string& text);

  std::string path_;
  video::Rational time_base_;
  int descriptor_ = -1;
  std::string last_;
};

/// The file of `--stats`, row by row, so that it needs no memory. One thread at a time.
class VideoStats {
 public:
  /// @param path  empty: none. @param head  what is known before the first frame.
  VideoStats(const std::string& path, const nlohmann::ordered_json& head);

  /// A row of `frames`.
  void add(const nlohmann::ordered_json& row);
  void finish(const nlohmann::ordered_json& tail);

 private:
  std::unique_ptr<OutputFile> file_;
  bool first_ = true;
};

/// Members of a row and of a summary, as docs/stats.md tells.
nlohmann::ordered_json row_json(const pipeline::FrameRow& row);
nlohmann::ordered_json drawn_json(const pipeline::FrameRow& row);  ///< of a frame that was only drawn
nlohmann::ordered_json summary_json(const pipeline::Summary& summary);

}  // namespace knotreel::cli
