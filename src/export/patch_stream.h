// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <functional>

#include "export/layers.h"
#include "knotreel/export/options.h"

namespace knotreel::exporting {

/// Counts triangles against the limit. One per file; any thread may spend.
class TriangleBudget {
 public:
  explicit TriangleBudget(std::uint64_t limit) : limit_(limit) {}
  /// @throws Error{kInvalidArgument} if that is more than the limit.
  void spend(std::size_t triangles);
  std::uint64_t spent() const { return spent_; }

 private:
  std::uint64_t limit_;
  std::atomic<std::uint64_t> spent_ = 0;
};

/// Hands out the patches of a layer in the order of painting, rims first. They are made block by block on all
/// threads allowed, and paid for while they are made; `visit` is called on the calling thread.
void for_each_patch(const Tessellator& tessellator, const Layer& layer,
                    const std::function<void()>& checkpoint, TriangleBudget& budget,
                    const std::function<void(const Patch&)>& visit);

/// Hands out the patches of all faces in order, in the same way.
void for_each_face(const Tessellator& tessellator, const std::function<void()>& checkpoint,
                   TriangleBudget& budget, const std::function<void(const Patch&)>& visit);

/// Box of everything that an export may draw: the control points of the geometry span it.
struct Box {
  Vec2 low;
  Vec2 high;
};
Box image_box(const document::FrameModel& model);

}  // namespace knotreel::exporting
