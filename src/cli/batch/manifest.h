// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "cli/batch/inputs.h"

namespace knotreel::cli::batch {

/// Figures of what was made of an input.
struct Figures {
  std::size_t knots = 0;
  std::size_t control_points = 0;
  double psnr = 0;  ///< dB; infinite for equal pictures
  std::uint64_t file_bytes = 0;
  std::uint64_t frames = 1;  ///< knots and control points are means over them
};

/// By which a changed input is known.
struct Stamp {
  std::uint64_t size = 0;
  std::int64_t mtime = 0;              ///< nanoseconds since 1970; of several files the latest
  std::optional<std::uint64_t> files;  ///< of a folder or a pattern, how many; size is their sum

  friend bool operator==(const Stamp&, const Stamp&) = default;
};

/// Of a file, or of the pictures that a folder or a pattern means; none if there are no such.
std::optional<Stamp> stamp_of(const std::string& path);

/// A line of the manifest, as docs/batch.md tells.
struct Entry {
  Item item;
  std::string status;  ///< "done", "failed", "skipped"
  std::string error;   ///< of "failed"
  std::optional<Figures> figures;
  std::optional<Stamp> stamp;
  double seconds = 0;
};

/// The last line of every input in a manifest. Lines that are cut off or no such lines are passed over;
/// without a file there are none. @throws Error{kInput} if the file is there but cannot be read.
std::map<std::string, Entry> read_manifest(const std::string& path);

/// Writes lines, each at once and whole. Safe to use from several threads.
class Manifest {
 public:
  /// @param path  `-`: standard output. @param keep  go on behind what is there. @throws Error{kOutput}
  Manifest(std::string path, bool keep);
  ~Manifest();
  Manifest(const Manifest&) = delete;
  Manifest& operator=(const Manifest&) = delete;

  /// @throws Error{kOutput}
  void add(const Entry& entry);

 private:
  /// Whole when it has got here, so that the file is closed if nothing can be written to it.
  explicit Manifest(std::string path) : path_(std::move(path)) {}
  void write(const std::string& text);

  std::mutex mutex_;
  std::string path_;
  int descriptor_ = -1;
};

}  // namespace knotreel::cli::batch
