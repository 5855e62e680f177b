// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/base/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>

namespace knotreel {
namespace fs = std::filesystem;

namespace {
// Encoders hand over many small pieces (a PNG chunk is three); one system call for each would cost more than
// the compression of a plain picture.
constexpr std::size_t kBufferBytes = 256 * 1024;

/// A name that no other object has, in this process or in another one that is alive.
fs::path part_name(fs::path target) {
  static std::atomic<unsigned> count{0};
  const unsigned number = ++count;
  target += "." + std::to_string(::getpid()) + (number > 1 ? "." + std::to_string(number) : "") + ".part";
  return target;
}

/// The file that links point to, which is not there yet.
/// @returns false if links go in circles.
bool follow_links(fs::path& target) {
  constexpr int kMost = 40;  // as the system's own bound
  std::error_code error;
  fs::path place = target;
  for (int i = 0; i < kMost; ++i) {
    if (!fs::is_symlink(place, error)) {
      target = place;
      return true;
    }
    place = place.parent_path() / fs::read_symlink(place, error);
  }
  return false;
}

/// @returns a descriptor of a new file, or -1 with errno.
int create(const fs::path& path, mode_t mode) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC;
  const int descriptor = ::open(path.c_str(), kFlags, mode);
  if (descriptor >= 0 || errno != EEXIST) return descriptor;
  // Left by a dead process that had the same id.
  ::unlink(path.c_str());
  return ::open(path.c_str(), kFlags, mode);
}
}  // namespace

OutputFile::OutputFile(const fs::path& path) : name_("'" + path.string() + "'"), target_(path) {
  buffer_.reserve(kBufferBytes);
  if (path == "-") {
    descriptor_ = STDOUT_FILENO;
    name_ = "standard output";
    return;
  }
  std::error_code ignored;
  // A symbolic link stays one: the file it points to is replaced, or made, in its own folder.
  if (!fs::exists(target_, ignored)) {
    if (!follow_links(target_)) fail(ELOOP);
  } else if (const fs::path real = fs::canonical(target_, ignored); !real.empty()) {
    target_ = real;  // pipes that are named by a link have no other name
  }
  struct stat status {};
  const bool exists = ::stat(target_.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) fail(EISDIR);
  if (exists && !S_ISREG(status.st_mode)) {
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    part_ = part_name(target_);
    descriptor_ = create(part_, exists ? 0600 : 0666);
    // What replaces a private file is private. Not all file systems know that.
    if (exists && descriptor_ >= 0) ::fchmod(descriptor_, status.st_mode & 0777);
    seekable_ = true;
  }
  if (descriptor_ < 0) {
    const int system_error = errno;
    part_.clear();
    fail(system_error);
  }
  owns_descriptor_ = true;
}

OutputFile::~OutputFile() {
  if (owns_descriptor_) ::close(descriptor_);
  if (!part_.empty()) ::unlink(part_.c_str());
}

void OutputFile::write(std::span<const std::byte> bytes) {
  size_ += bytes.size();
  if (buffer_.size() + bytes.size() > kBufferBytes) flush();
  if (bytes.size() >= kBufferBytes) {
    write_all(bytes.data(), bytes.size(), -1);
  } else {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  }
}

void OutputFile::write(const std::string& text) {
  write(std::as_bytes(std::span(text)));
}

void OutputFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (!seekable_) fail(ESPIPE);
  write_all(bytes.data(), bytes.size(), static_cast<std::int64_t>(offset));
}

void OutputFile::commit() {
  flush();
  if (!owns_descriptor_) return;
  owns_descriptor_ = false;
  // Some file systems report a full disk or quota only here.
  if (::close(descriptor_) != 0) fail(errno);
  if (part_.empty()) return;
  if (::rename(part_.c_str(), target_.c_str()) != 0) fail(errno);
  part_.clear();
}

void OutputFile::flush() {
  write_all(buffer_.data(), buffer_.size(), -1);
  buffer_.clear();
}

void OutputFile::write_all(const std::byte* data, std::size_t count, std::int64_t offset) {
  while (count > 0) {
    const ssize_t done =
        offset < 0 ? ::write(descriptor_, data, count) : ::pwrite(descriptor_, data, count, offset);
    if (done < 0) {
      if (errno == EINTR) continue;
      fail(errno);
    }
    data += done;
    count -= static_cast<std::size_t>(done);
    if (offset >= 0) offset += done;
  }
}

void OutputFile::fail(int system_error) const {
  const std::string message = "cannot write " + name_ + ": " + std::generic_category().message(system_error);
  if (system_error == EPIPE) throw BrokenPipe(ErrorKind::kOutput, message);
  throw Error(ErrorKind::kOutput, message);
}

}  // namespace knotreel
