// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/allocations.h"

#include <stdlib.h>

#include <atomic>
#include <cstddef>

namespace {

std::atomic<std::uint64_t> calls{0};
std::atomic<std::uint64_t> bytes{0};

[[maybe_unused]] void count(std::size_t size) {
  calls.fetch_add(1, std::memory_order_relaxed);
  bytes.fetch_add(size, std::memory_order_relaxed);
}

}  // namespace

#ifdef __GLIBC__
// glibc lets programs put functions of their own in the place of these.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);

void* malloc(std::size_t size) {
  count(size);
  return __libc_malloc(size);
}

void* calloc(std::size_t number, std::size_t size) {
  count(number * size);
  return __libc_calloc(number, size);
}
}
#endif

namespace knotreel::bench {

Allocations allocations() {
  return {calls.load(), bytes.load()};
}

}  // namespace knotreel::bench
