// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

#include "knotreel/base/error.h"

namespace knotreel {

/// Caps the threads that the whole process uses for parallel_for (and everything built on oneTBB) from now on
/// and until the object is destroyed. 0 means all cores. Of several that exist the least holds; each belongs
/// to the thread that made it.
/// @throws Error{kInternal} if the system does not allow for as many threads, or one per core if these are
/// fewer.
class ThreadCap {
 public:
  explicit ThreadCap(int threads);
  ~ThreadCap();
  ThreadCap(const ThreadCap&) = delete;
  ThreadCap& operator=(const ThreadCap&) = delete;

 private:
  void* impl_;
};

/// As many as the caps allow now. For how much to have in work at once, not for what comes of it.
std::size_t threads_allowed();

/// Calls body(i) for every i in [0, count), in any order, on the threads allowed. The body must only write
/// what belongs to its own i, so that the result cannot depend on the number of threads. Exceptions from a
/// body cancel the loop and are rethrown here.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// While one exists, the loops of the thread that made it are what others wait for: threads at work on loops
/// that are not urgent help with them after each of their own calls of a body. So the bodies of all loops
/// must leave nothing behind in their thread that the next call counts on.
class Urgent {
 public:
  /// @param really false: whatever held before still does.
  explicit Urgent(bool really = true);
  ~Urgent();
  Urgent(const Urgent&) = delete;
  Urgent& operator=(const Urgent&) = delete;

 private:
  bool before_;
};

/// Calls both, at the same time if threads are idle. Neither may write what the other reads. Exceptions are
/// rethrown here.
void parallel_invoke(const std::function<void()>& first, const std::function<void()>& second);

}  // namespace knotreel
