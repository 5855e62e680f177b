// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/base/input_file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <string>
#include <system_error>

#include "knotreel/base/error.h"

namespace knotreel {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& kind, const std::string& why) {
  throw Error(ErrorKind::kInput, cannot_read(path, kind) + why);
}

void (*check_while_waiting)() = nullptr;

/// Until a pipe has something to give, or nobody writes to it any more. A named one may have had no writer
/// yet.
void wait_for_input(int descriptor) {
  constexpr int kMilliseconds = 100;
  pollfd wait{descriptor, POLLIN, 0};
  while (::poll(&wait, 1, kMilliseconds) <= 0) {
    check_while_working();
  }
}

bool is_pipe(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISFIFO(status.st_mode);
}

/// An open descriptor; standard input is not closed.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, const std::string& kind, bool dash_is_stdin) {
    if (dash_is_stdin && path == "-") {
      value_ = STDIN_FILENO;
      return;
    }
    std::error_code ignored;
    // To open a named pipe would wait for its writer, and hear nothing.
    const int wait = std::filesystem::is_fifo(path, ignored) ? O_NONBLOCK : 0;
    value_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | wait);
    if (value_ < 0) fail(path, kind, std::generic_category().message(errno));
    owned_ = true;
  }
  ~Descriptor() {
    if (owned_) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }

 private:
  int value_ = -1;
  bool owned_ = false;
};

/// Reads until `bytes` is full or the input ends; shrinks it to what came.
std::size_t read_into(int descriptor, std::byte* to, std::size_t count, const std::filesystem::path& path,
                      const std::string& kind) {
  std::size_t got = 0;
  const bool pipe = is_pipe(descriptor);
  while (got < count) {
    if (pipe) wait_for_input(descriptor);
    const ssize_t done = ::read(descriptor, to + got, count - got);
    if (done < 0) {
      if (errno == EINTR || errno == EAGAIN) continue;
      fail(path, kind, std::generic_category().message(errno));
    }
    if (done == 0) break;
    got += static_cast<std::size_t>(done);
  }
  return got;
}

}  // namespace

void set_check_while_waiting(void (*check)()) {
  check_while_waiting = check;
}

void check_while_working() {
  if (check_while_waiting != nullptr) check_while_waiting();
}

std::string cannot_read(const std::filesystem::path& path, const std::string& kind) {
  std::string message = "cannot read ";
  if (!kind.empty()) message += kind + " ";
  if (path != "-") return message + "'" + path.string() + "': ";
  return message + (kind.empty() ? "standard input: " : "from standard input: ");
}

std::vector<std::byte> read_start(const std::filesystem::path& path, std::size_t count) {
  const Descriptor descriptor(path, {}, false);
  std::vector<std::byte> bytes(count);
  bytes.resize(read_into(descriptor.get(), bytes.data(), count, path, {}));
  return bytes;
}

std::vector<std::byte> read_whole(const std::filesystem::path& path, std::uint64_t max_bytes,
                                  const std::string& kind) {
  const Descriptor descriptor(path, kind, true);
  struct stat status {};
  std::size_t expected = 0;
  if (::fstat(descriptor.get(), &status) == 0 && S_ISREG(status.st_mode)) {
    expected = static_cast<std::size_t>(
        std::min<std::uint64_t>(static_cast<std::uint64_t>(status.st_size), max_bytes));
  }
  std::vector<std::byte> bytes;
  try {
    // One byte more than expected, so that the end of a regular file is seen in the first round.
    std::size_t step = expected + 1;
    while (true) {
      const std::size_t before = bytes.size();
      bytes.resize(before + step);
      const std::size_t got = read_into(descriptor.get(), bytes.data() + before, step, path, kind);
      bytes.resize(before + got);
      if (bytes.size() > max_bytes) {
        fail(path, kind, "larger than the " + std::to_string(max_bytes >> 20) + " MiB that are accepted");
      }
      if (got < step) return bytes;
      // As much again, but not more than one byte beyond what is accepted: that is enough to refuse it.
      step = static_cast<std::size_t>(std::min<std::uint64_t>(std::max<std::size_t>(bytes.size(), 1 << 16),
                                                              max_bytes - bytes.size() + 1));
    }
  } catch (const std::bad_alloc&) {
    fail(path, kind, "not enough memory");
  }
}

}  // namespace knotreel
