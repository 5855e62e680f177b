// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>

namespace knotreel::pipeline {

/// A stream into a file that is written as OutputFile writes, or only counted. One thread at a time.
class DocumentStream {
 public:
  /// @param path  `-`: standard output; empty: nothing is kept. @throws as OutputFile.
  explicit DocumentStream(const std::string& path);
  ~DocumentStream();

  /// Errors of the file leave it as they are, with the system's reason.
  std::ostream& out() { return out_; }

  /// Bytes so far.
  std::uint64_t bytes() const;

  /// Gives the file its name.
  void commit();

 private:
  class FileBuffer;
  std::unique_ptr<FileBuffer> buffer_;
  std::ostream out_;
};

}  // namespace knotreel::pipeline
