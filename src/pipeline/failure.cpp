// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/failure.h"

#include <new>

#include "knotreel/base/error.h"
#include "knotreel/base/output_file.h"

namespace knotreel::pipeline {

void FirstFailure::keep(std::uint64_t frame, const char* stage) {
  const std::lock_guard lock(mutex_);
  if (exception_) return;
  exception_ = std::current_exception();
  where_ = "frame " + std::to_string(frame) + ", " + stage + ": ";
  failed_.store(true, std::memory_order_release);
}

void FirstFailure::rethrow() const {
  if (!exception_) return;
  try {
    std::rethrow_exception(exception_);
  } catch (const BrokenPipe& e) {
    throw BrokenPipe(e.kind(), where_ + e.what());
  } catch (const Error& e) {
    throw Error(e.kind(), where_ + e.what());
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::kInternal, where_ + "not enough memory");
  } catch (const std::exception& e) {
    throw Error(ErrorKind::kInternal, where_ + "internal error: " + e.what());
  }
}

}  // namespace knotreel::pipeline
