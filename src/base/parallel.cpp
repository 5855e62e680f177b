#include "knotreel/base/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include "knotreel/base/happens_before.h"

namespace knotreel {

ThreadCap::ThreadCap(int threads) : impl_(nullptr) {
  const int cap = threads > 0 ? threads : oneapi::tbb::info::default_concurrency();
  impl_ = new oneapi::tbb::global_control(oneapi::tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(cap));
}

ThreadCap::~ThreadCap() {
  delete static_cast<oneapi::tbb::global_control*>(impl_);
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  HappensBefore begun;
  HappensBefore ended;
  begun.release();
  oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    begun.acquire();
    body(i);
    ended.release();
  });
  ended.acquire();
}

void parallel_invoke(const std::function<void()>& first, const std::function<void()>& second) {
  parallel_for(2, [&](std::size_t i) { i == 0 ? first() : second(); });
}

}  // namespace knotreel
