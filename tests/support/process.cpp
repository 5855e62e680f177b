// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace knotreel::test {
namespace {

namespace fs = std::filesystem;

struct Pipe {
  int read_end = -1;
  int write_end = -1;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe2 failed");
    read_end = ends[0];
    write_end = ends[1];
  }
  ~Pipe() {
    close_read();
    close_write();
  }
  void close_read() { close(read_end); }
  void close_write() { close(write_end); }
  static void close(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }
};

[[noreturn]] void become(const std::vector<std::string>& command, const ProcessOptions& options, int in,
                         int out, int err) {
  if (!options.output_file.empty())
    out = ::open(options.output_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  ::dup2(in, STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  ::signal(SIGPIPE, SIG_DFL);
  if (options.max_file_bytes > 0) {
    const rlimit limit{options.max_file_bytes, options.max_file_bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

bool begins_in_folder(const fs::path& prefix, std::uintmax_t bytes) {
  for (const auto& entry : fs::directory_iterator(prefix.parent_path())) {
    if (!entry.path().string().starts_with(prefix.string())) continue;
    std::error_code gone;
    const std::uintmax_t size = fs::file_size(entry.path(), gone);
    if (!gone && size >= bytes) return true;
  }
  return false;
}

/// Whether a process has a handler for a signal, or can have none.
bool is_ready_for(int signal, pid_t process) {
  if (signal == SIGKILL) return true;
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  const std::string caught = "SigCgt:\t";
  for (std::string line; std::getline(status, line);) {
    if (!line.starts_with(caught)) continue;
    return (std::stoull(line.substr(caught.size()), nullptr, 16) >> (signal - 1) & 1) != 0;
  }
  return true;
}

/// Reads what is there; closes the pipe at its end.
void drain(int& end, std::string& text) {
  char buffer[65536];
  const ssize_t got = ::read(end, buffer, sizeof buffer);
  if (got > 0) {
    text.append(buffer, std::size_t(got));
  } else {
    Pipe::close(end);
  }
}

}  // namespace

ProcessResult run(const std::vector<std::string>& command, const ProcessOptions& options) {
  ::signal(SIGPIPE, SIG_IGN);  // the program may close its input early
  Pipe in;
  Pipe out;
  Pipe err;
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) become(command, options, in.read_end, out.write_end, err.write_end);
  in.close_read();
  out.close_write();
  err.close_write();
  ::fcntl(in.write_end, F_SETFL, O_NONBLOCK);

  ProcessResult result;
  std::size_t given = 0;
  bool signalled = options.signal == 0;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (out.read_end >= 0 || err.read_end >= 0) {
    if (given == options.input.size() && !options.keep_input_open) in.close_write();
    pollfd waits[] = {{out.read_end, POLLIN, 0},
                      {err.read_end, POLLIN, 0},
                      {given < options.input.size() ? in.write_end : -1, POLLOUT, 0}};
    ::poll(waits, 3, signalled ? 1000 : 2);
    if ((waits[0].revents & (POLLIN | POLLHUP)) != 0) drain(out.read_end, result.out);
    if ((waits[1].revents & (POLLIN | POLLHUP)) != 0) drain(err.read_end, result.err);
    if ((waits[2].revents & (POLLOUT | POLLERR)) != 0) {
      const ssize_t put = ::write(in.write_end, options.input.data() + given, options.input.size() - given);
      given = put > 0 ? given + std::size_t(put) : options.input.size();
    }
    if (options.close_output_after > 0 && result.out.size() >= options.close_output_after) out.close_read();
    if (!signalled && begins_in_folder(options.signal_once, options.signal_at_bytes) &&
        is_ready_for(options.signal, child)) {
      ::kill(child, options.signal);
      signalled = true;
      if (options.second_signal != 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(options.milliseconds_between));
        ::kill(child, options.second_signal);
      }
    }
    if (std::chrono::steady_clock::now() > deadline) ::kill(child, SIGKILL);
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  result.peak_memory_bytes = std::size_t(usage.ru_maxrss) * 1024;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace knotreel::test
