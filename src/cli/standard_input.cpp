#include "cli/standard_input.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

namespace knotreel::cli {
namespace {

/// What is in the pipe now, copied by way of a second one: tee() takes nothing away.
std::vector<std::byte> copy_of_pipe(std::size_t count) {
  std::vector<std::byte> bytes(count);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return {};
  const ssize_t copied = ::tee(STDIN_FILENO, ends[1], count, 0);
  const ssize_t got = copied > 0 ? ::read(ends[0], bytes.data(), static_cast<std::size_t>(copied)) : 0;
  ::close(ends[0]);
  ::close(ends[1]);
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return bytes;
}

bool writer_has_gone() {
  pollfd wait{STDIN_FILENO, 0, 0};
  return ::poll(&wait, 1, 0) > 0 && (wait.revents & (POLLHUP | POLLERR)) != 0;
}

}  // namespace

std::vector<std::byte> peek_standard_input(std::size_t count) {
  struct stat status {};
  if (::fstat(STDIN_FILENO, &status) != 0) return {};
  if (S_ISREG(status.st_mode)) {
    std::vector<std::byte> bytes(count);
    const ssize_t got = ::pread(STDIN_FILENO, bytes.data(), count, ::lseek(STDIN_FILENO, 0, SEEK_CUR));
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    return bytes;
  }
  if (!S_ISFIFO(status.st_mode)) return {};
  for (;;) {
    const bool last = writer_has_gone();  // asked first: what it wrote before is there by now
    std::vector<std::byte> bytes = copy_of_pipe(count);
    if (last || bytes.size() == count || bytes.empty()) return bytes;
    constexpr useconds_t kPause = 2000;  // a writer that begins with less is rare
    ::usleep(kPause);
  }
}

}  // namespace knotreel::cli
