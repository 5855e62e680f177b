// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>

#include "knotreel/base/parallel.h"

namespace knotreel::cli::batch {

/// Where the work is done that needs memory. Large jobs are in it alone. The threads that the program may use
/// are shared by the jobs that are at work: what those do not take themselves their parallel loops get.
class Room {
 public:
  /// @param workers  threads that take jobs; @param threads  of the program, at least as many.
  Room(int workers, int threads);

  /// In the room until destroyed.
  class Stay {
   public:
    explicit Stay(Room& room) : room_(&room) {}
    Stay(Stay&& other) noexcept : room_(other.room_) { other.room_ = nullptr; }
    Stay& operator=(Stay&&) = delete;
    ~Stay() {
      if (room_ != nullptr) room_->leave();
    }

   private:
    Room* room_;
  };

  /// Waits until there is room: for a large job until nobody else is in it.
  Stay enter(bool large);

  /// A worker has no more to do.
  void retire();

 private:
  void leave();
  void share_threads();

  std::mutex mutex_;
  std::condition_variable changed_;
  int threads_;
  int working_;            // neither waiting nor retired
  int inside_ = 0;         // jobs in the room
  int large_waiting_ = 0;  // they go first, or else they would wait for ever
  bool alone_ = false;     // the one in the room is large
  std::optional<ThreadCap> cap_;
};

/// How many at once.
struct Crew {
  int workers = 1;
  int threads = 1;
};

/// Calls job(i, room) for every i below `count`, in this order, on so many workers, and `tick` on the calling
/// thread a few times a second. The first exception stops the handing out of jobs and is rethrown here when
/// those at work have ended.
void run_jobs(std::size_t count, const Crew& crew, const std::function<void(std::size_t, Room&)>& job,
              const std::function<void()>& tick);

}  // namespace knotreel::cli::batch
