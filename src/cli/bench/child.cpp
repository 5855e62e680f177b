// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench/child.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <future>
#include <iterator>

#include "cli/interrupt.h"
#include "knotreel/base/error.h"

namespace knotreel::cli::bench {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

pid_t start(const std::vector<std::string>& arguments, const std::string& output, const std::string& errors) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  std::vector<char*> words{const_cast<char*>(self.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output.c_str(), kWrite, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, errors.c_str(), kWrite, 0600);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, self.c_str(), &files, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) {
    throw Error(ErrorKind::kInternal, std::string("cannot start a child process: ") + std::strerror(error));
  }
  return child;
}

/// Until it has ended. It stays to be waited for, so that nobody else gets its number.
void await_end(pid_t child) {
  siginfo_t ignored{};
  while (::waitid(P_PID, id_t(child), &ignored, WEXITED | WNOWAIT) < 0 && errno == EINTR) continue;
}

/// Its exit code, or 128 and the number of the signal that ended it. It is told when a signal comes, which
/// may have been meant for this process alone, and then ends in order.
int wait_for(pid_t child) {
  constexpr std::chrono::milliseconds kLook{50};
  const auto end = std::async(std::launch::async, await_end, child);
  bool told = false;
  while (end.wait_for(kLook) != std::future_status::ready) {
    if (!told && interrupted()) told = ::kill(child, SIGTERM) == 0;
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string last_line(std::string text) {
  constexpr const char* kPrefix = "knotreel: ";
  while (text.ends_with('\n')) text.pop_back();
  text.erase(0, text.find_last_of('\n') + 1);
  return text.starts_with(kPrefix) ? text.substr(std::strlen(kPrefix)) : text;
}

ErrorKind kind_of(int code) {
  for (const ErrorKind kind :
       {ErrorKind::kInvalidArgument, ErrorKind::kInput, ErrorKind::kOutput, ErrorKind::kInterrupted}) {
    if (exit_code(kind) == code) return kind;
  }
  return ErrorKind::kInternal;
}

}  // namespace

ChildResult run_self(const std::vector<std::string>& arguments, const Scratch& scratch) {
  check_interrupted();
  const std::string output = scratch.path("child-output");
  const std::string errors = scratch.path("child-errors");
  const auto begin = std::chrono::steady_clock::now();
  const int code = wait_for(start(arguments, output, errors));
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  check_interrupted();
  if (code == 0) return {passed.count(), text_of(output)};
  const std::string line = last_line(text_of(errors));
  throw Error(kind_of(code), line.empty() ? "a child process ended with code " + std::to_string(code) : line);
}

}  // namespace knotreel::cli::bench
