// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/interrupt.h"

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>

#include "knotreel/base/error.h"

namespace knotreel::cli {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

/// Signals that come so soon after the first one are the same one: a terminal that closes is told by the
/// system and by the shell, and `timeout` tells the program and its group.
constexpr std::int64_t kTwice = 300'000'000;  // nanoseconds

std::atomic<std::int64_t> first_signal = 0;  // when it came, nanoseconds; 0: not yet
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "or a handler may not touch it");

void on_signal(int signal) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t time = now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec + 1;
  std::int64_t first = 0;
  if (first_signal.compare_exchange_strong(first, time) || time - first < kTwice) return;
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int signal : kSignals) {
    struct sigaction present {};
    // What nohup or a background shell has switched off stays off.
    if (sigaction(signal, nullptr, &present) == 0 && present.sa_handler == SIG_IGN) continue;
    sigaction(signal, &action, nullptr);
  }
  // A closed pipe and a file grown too large are errors of writing, and told as such.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() {
  return first_signal != 0;
}

void check_interrupted() {
  if (interrupted()) throw Error(ErrorKind::kInterrupted, "interrupted");
}

}  // namespace knotreel::cli
