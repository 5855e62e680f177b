// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace knotreel::document {

/// Bytes that can be read anywhere: a file or memory.
class ByteSource {
 public:
  virtual ~ByteSource() = default;

  /// When the source was opened; a file that grows is read up to there.
  virtual std::uint64_t size() const = 0;

  /// @pre offset + count <= size(). @throws Error{kInput} if the file cannot be read.
  virtual std::vector<std::byte> read(std::uint64_t offset, std::size_t count) = 0;

  /// For messages.
  virtual const std::string& name() const = 0;
};

/// @throws Error{kInput} if the path is no readable regular file.
std::unique_ptr<ByteSource> open_file(const std::filesystem::path& path);
std::unique_ptr<ByteSource> open_memory(std::vector<std::byte> bytes, std::string name);

}  // namespace knotreel::document
