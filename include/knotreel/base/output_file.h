// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "knotreel/base/error.h"

namespace knotreel {

/// The reader of a pipe that we write to has gone away. A kOutput error of its own type, because a program in
/// a pipeline ends quietly then.
class BrokenPipe : public Error {
 public:
  using Error::Error;
};

/// A file that appears under its name only once it is whole. Bytes go to a `.part` file in the same folder,
/// which commit() renames; an object that is destroyed without commit() removes it and leaves whatever had
/// the name before. `-` is standard output, which, like devices and pipes, is written directly. One thread at
/// a time. Every failure is an Error{kOutput} with the path and the system's reason; writing to a pipe
/// without a reader throws BrokenPipe provided that SIGPIPE is ignored.
class OutputFile {
 public:
  /// Opens the `.part` file, or what is written directly.
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Appends.
  void write(std::span<const std::byte> bytes);
  void write(const std::string& text);

  /// Writes at an offset from the start, without moving the place where write() goes on.
  /// Only for seekable() outputs.
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Whether write_at() works: there is a `.part` file.
  bool seekable() const { return seekable_; }

  /// Hands over what is still held back, so that a killed program leaves it in the `.part` file.
  void flush();

  /// Bytes given to write() so far.
  std::uint64_t size() const { return size_; }

  /// Flushes, closes and renames. Nothing may be written afterwards.
  void commit();

  /// Where the bytes are until commit(), but for what write() still holds back.
  const std::filesystem::path& place() const { return part_.empty() ? target_ : part_; }

  /// For messages: the path as given, in quotes, or "standard output".
  const std::string& name() const { return name_; }

 private:
  void write_all(const std::byte* data, std::size_t count, std::int64_t offset);
  [[noreturn]] void fail(int system_error) const;

  std::string name_;
  std::filesystem::path target_;
  std::filesystem::path part_;  // empty: written directly
  int descriptor_ = -1;
  bool owns_descriptor_ = false;
  bool seekable_ = false;
  std::uint64_t size_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace knotreel
