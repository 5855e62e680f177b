// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/standard_input.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>

#include "cli/interrupt.h"

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

/// Waits a moment for the pipe to be worth a look.
short wait_for_pipe() {
  constexpr int kMilliseconds = 50;
  pollfd wait{STDIN_FILENO, POLLIN, 0};
  return ::poll(&wait, 1, kMilliseconds) > 0 ? wait.revents : short{0};
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
    check_interrupted();
    const short events = wait_for_pipe();  // first: what a writer that has gone wrote is there by now
    if (events == 0) continue;
    std::vector<std::byte> bytes = copy_of_pipe(count);
    const bool last = (events & (POLLHUP | POLLERR)) != 0;
    if (last || bytes.size() == count || bytes.empty()) return bytes;
    constexpr useconds_t kPause = 2000;  // a writer that begins with less is rare
    ::usleep(kPause);
  }
}

std::string pipe_as_standard_input(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISFIFO(status.st_mode)) return path;
  // To open it would wait for its writer, and hear nothing.
  const int pipe = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (pipe < 0) return path;  // to be told by who reads it
  ::dup2(pipe, STDIN_FILENO);
  ::close(pipe);
  peek_standard_input(1);
  ::fcntl(STDIN_FILENO, F_SETFL, ::fcntl(STDIN_FILENO, F_GETFL) & ~O_NONBLOCK);
  return "-";
}

}  // namespace knotreel::cli
