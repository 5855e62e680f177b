// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/patch_stream.h"

#include <algorithm>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::exporting {

void TriangleBudget::spend(std::size_t triangles) {
  if ((spent_ += triangles) > limit_) {
    throw Error(ErrorKind::kInvalidArgument, "the export takes more than " + std::to_string(limit_) +
                                                 " triangles; allow larger errors or more triangles");
  }
}

namespace {

/// Calls visit(make(i)) for i below count in order, making them block by block on all threads allowed.
void in_blocks(std::size_t count, const std::function<void()>& checkpoint,
               const std::function<Patch(std::size_t)>& make,
               const std::function<void(const Patch&)>& visit) {
  constexpr std::size_t kBlock = 512;
  std::vector<Patch> patches;
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    if (checkpoint) checkpoint();
    patches.clear();
    patches.resize(std::min(kBlock, count - begin));
    parallel_for(patches.size(), [&](std::size_t i) { patches[i] = make(begin + i); });
    for (const Patch& patch : patches) visit(patch);
  }
}

}  // namespace

void for_each_patch(const Tessellator& tessellator, const Layer& layer,
                    const std::function<void()>& checkpoint, TriangleBudget& budget,
                    const std::function<void(const Patch&)>& visit) {
  const auto& under = layer.underlay;
  const auto& rims = layer.rims;
  const auto spend = [&](std::size_t triangles) { budget.spend(triangles); };
  const auto make = [&](std::size_t i) {
    if (i < under.size()) return tessellator.face(under[i], spend);
    i -= under.size();
    if (i >= rims.size()) return tessellator.face(layer.faces[i - rims.size()], spend);
    Patch patch = rim_patch(tessellator, rims[i]);
    spend(patch.triangles.size());
    return patch;
  };
  in_blocks(under.size() + rims.size() + layer.faces.size(), checkpoint, make, visit);
}

void for_each_face(const Tessellator& tessellator, const std::function<void()>& checkpoint,
                   TriangleBudget& budget, const std::function<void(const Patch&)>& visit) {
  const auto spend = [&](std::size_t triangles) { budget.spend(triangles); };
  in_blocks(
      tessellator.face_count(), checkpoint, [&](std::size_t f) { return tessellator.face(f, spend); }, visit);
}

Box image_box(const document::FrameModel& model) {
  const std::vector<Vec2> sites = model.space->geometry_greville();
  const auto& mesh = model.space->mesh();
  Box box{{0, 0}, {mesh.width, mesh.height}};
  for (std::size_t g = 0; g < sites.size(); ++g) {
    const Vec2 x = sites[g] + model.displacement[g];
    box.low = {std::min(box.low.x, x.x), std::min(box.low.y, x.y)};
    box.high = {std::max(box.high.x, x.x), std::max(box.high.y, x.y)};
  }
  return box;
}

void check_options(const ExportOptions& options) {
  if (!(options.scale >= 0.001 && options.scale <= 1000)) {
    throw Error(ErrorKind::kInvalidArgument, "the scale of an export must be 0.001 to 1000");
  }
  check_tolerances(options.tessellation);
}

}  // namespace knotreel::exporting
