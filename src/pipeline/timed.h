// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "pipeline/failure.h"
#include "pipeline/message.h"
#include "pipeline/picture_output.h"
#include "pipeline/thread_number.h"

namespace knotreel::pipeline {

/// Runs one stage of one message, on a clock. After a failure, of this stage or another, it does nothing.
template <class Body>
void timed(FirstFailure& failure, const char* stage, Message& message, Body&& body) {
  if (failure.any()) return;
  const Clock::time_point start = Clock::now();
  try {
    std::forward<Body>(body)();
  } catch (...) {
    failure.keep(message.index, stage);
  }
  const Clock::time_point end = Clock::now();
  const std::chrono::duration<double, std::milli> passed = end - start;
  message.row.milliseconds.emplace_back(stage, passed.count());
  message.row.spans.push_back({stage, start, end, thread_number()});
}

}  // namespace knotreel::pipeline
