// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::track {

struct SettleOptions {
  double first_step = 0.1;  ///< of a knot, as a share of its shortest edge
  double least = 0.03;      ///< pixels; a knot whose steps got shorter has settled and rests
  /// So does one whose step would mend a smaller share of the mean error per knot: it would only flicker.
  double least_gain = 0.04;
  int nap = 2;  ///< times that a knot that rests is not even looked at
};

/// Steps of knots against the gradient of the error, one every few frames: each grows while its direction
/// stays and shrinks when it turns, so that knots come to rest where the picture does. Knots are known by
/// their ids.
class Settling {
 public:
  explicit Settling(const SettleOptions& options) : options_(options) {}

  /// Knots whose gradient moves() wants to see: 1, all others: 0.
  /// @param resting by knot, 1 where the picture does not change: once settled, such a knot sleeps on.
  /// @param at_once settled or not: what it would gain is not worth the bytes and the time in drawings
  /// (docs/decisions/0046).
  std::vector<std::uint8_t> awake(const mesh::KnotMesh& mesh, std::span<const std::uint8_t> resting,
                                  bool at_once = false) const;

  /// @param gradient of the squared error by knot. @param error the squared error, of the whole picture.
  /// @return moves by knot, pixels.
  std::vector<Vec2> moves(const mesh::KnotMesh& mesh, const std::vector<Vec2>& gradient, double error);

  /// Ends all naps: the error has risen.
  void wake();

  void clear() { steps_.clear(); }

 private:
  struct Step {
    double length = 0;
    Vec2 direction;
    int nap = 0;           ///< times left
    bool settled = false;  ///< it has not moved since its last nap
  };
  SettleOptions options_;
  std::unordered_map<std::uint32_t, Step> steps_;
};

}  // namespace knotreel::track
