// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "features/fan.h"
#include "knotreel/features/known_corners.h"

namespace knotreel::features {

/// Fans that were fitted, by all that they hang on.
class KnownCorners::Fans {
 public:
  /// Forgets those that the last pictures, of which some may be worked on still, had no use for.
  void begin_picture();

  /// fit_fan() of these.
  std::optional<FanFit> fit(const image::Image& image, const Fan& start, const std::vector<Vec2>& through);

  std::size_t size() const;

 private:
  struct Known {
    std::optional<FanFit> fit;
    std::uint64_t last = 0;  ///< picture that asked for it
  };

  mutable std::mutex mutex_;
  std::unordered_map<std::string, Known> known_;
  std::uint64_t picture_ = 0;
};

}  // namespace knotreel::features
