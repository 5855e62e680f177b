#include "pipeline/failure.h"

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
  }
}

}  // namespace knotreel::pipeline
