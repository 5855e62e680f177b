// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/byte_source.h"

#include <fstream>
#include <system_error>

#include "knotreel/base/error.h"

namespace knotreel::document {
namespace {

class FileSource : public ByteSource {
 public:
  explicit FileSource(const std::filesystem::path& path) : name_(path.string()) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) fail("no such file");
    if (std::filesystem::is_directory(status)) fail("is a directory");
    if (!std::filesystem::is_regular_file(status)) fail("is not a regular file");
    file_.open(path, std::ios::binary);
    if (!file_) fail("cannot be opened");
    size_ = std::filesystem::file_size(path, error);
    if (error) fail("has no size: " + error.message());
  }

  std::uint64_t size() const override { return size_; }
  const std::string& name() const override { return name_; }

  std::vector<std::byte> read(std::uint64_t offset, std::size_t count) override {
    std::vector<std::byte> bytes(count);
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(offset));
    file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
    if (!file_) fail("cannot be read at byte " + std::to_string(offset));
    return bytes;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::kInput, name_ + ": " + what);
  }

  std::string name_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
};

class MemorySource : public ByteSource {
 public:
  MemorySource(std::vector<std::byte> bytes, std::string name)
      : bytes_(std::move(bytes)), name_(std::move(name)) {}

  std::uint64_t size() const override { return bytes_.size(); }
  const std::string& name() const override { return name_; }

  std::vector<std::byte> read(std::uint64_t offset, std::size_t count) override {
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(offset);
    return {begin, begin + static_cast<std::ptrdiff_t>(count)};
  }

 private:
  std::vector<std::byte> bytes_;
  std::string name_;
};

}  // namespace

std::unique_ptr<ByteSource> open_file(const std::filesystem::path& path) {
  return std::make_unique<FileSource>(path);
}

std::unique_ptr<ByteSource> open_memory(std::vector<std::byte> bytes, std::string name) {
  return std::make_unique<MemorySource>(std::move(bytes), std::move(name));
}

}  // namespace knotreel::document
