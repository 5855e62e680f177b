// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

namespace knotreel::pipeline {

/// A small number for each thread, 0, 1, 2, ... in the order of their first calls.
inline int thread_number() {
  static std::atomic<int> next{0};
  thread_local const int number = next++;
  return number;
}

}  // namespace knotreel::pipeline
