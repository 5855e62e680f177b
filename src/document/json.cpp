// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/document/json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/spline/space.h"

namespace knotreel::document {
namespace {

using Json = nlohmann::ordered_json;  // keys in the order in which they are documented
using mesh::KnotIndex;

/// Numbers the copies of multiple knots.
class Instances {
 public:
  Instances(const mesh::KnotMesh& mesh, int degree) {
    for (const mesh::Knot& k : mesh.knots) {
      first_.push_back(count_);
      multiplicity_.push_back(k.kind == mesh::KnotKind::kVertex ? static_cast<std::uint32_t>(degree) + 1 : 1);
      count_ += multiplicity_.back();
    }
    used_.assign(first_.size(), 0);
  }

  std::uint32_t multiplicity(KnotIndex k) const { return multiplicity_[k]; }
  std::uint32_t first(KnotIndex k) const { return first_[k]; }

  /// The copy of k not used yet in one t-config. I takes its copies first, T the next.
  std::uint32_t take(KnotIndex k) { return first_[k] + std::min(used_[k]++, multiplicity_[k] - 1); }
  void give_back(KnotIndex k) { --used_[k]; }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> multiplicity_;
  std::vector<std::uint32_t> used_;
  std::uint32_t count_ = 0;
};

Json function_json(const FrameModel& model, spline::FunctionIndex f,
                   const std::vector<std::array<mesh::CornerIndex, 3>>& triangles, Instances& instances) {
  const spline::SplineSpace& space = *model.space;
  const auto knot = [&](mesh::CornerIndex c) { return space.cut().corners[c].knot; };
  const auto inner = std::span(space.functions()[f].knots).first(static_cast<std::size_t>(space.degree()));

  Json json;
  json["id"] = model.function_ids.empty() ? f : model.function_ids[f];
  Json& i = json["I"] = Json::array();
  for (const auto c : inner) i.push_back(instances.take(knot(c)));
  Json& t = json["T"] = Json::array();
  for (const auto& triangle : triangles) {
    Json places = Json::array();
    for (const auto c : triangle) places.push_back(instances.take(knot(c)));
    for (const auto c : triangle) instances.give_back(knot(c));
    t.push_back(std::move(places));
  }
  for (const auto c : inner) instances.give_back(knot(c));

  const Vec2 site = space.greville(f) + model.displacement[space.geometry_of()[f]];
  Json& control = json["c"] = Json::array({site.x, site.y});
  const auto channels = static_cast<std::size_t>(model.channels);
  for (std::size_t c = 0; c < channels; ++c) control.push_back(model.colour[channels * f + c]);
  return json;
}

}  // namespace

std::string frame_to_json(const FrameModel& model, const SequenceInfo& info) {
  const std::optional<std::string> defect = find_defect(model);
  if (defect) throw Error(ErrorKind::kInvalidArgument, "cannot print a frame: " + *defect);
  const spline::SplineSpace& space = *model.space;
  const mesh::KnotMesh& mesh = space.mesh();
  Instances instances(mesh, space.degree());

  Json json;
  json["degree"] = space.degree();
  json["width"] = info.width;
  json["height"] = info.height;
  json["channels"] = model.channels;
  json["frame"] = model.frame;
  json["pts"] = model.pts;
  json["time_base"] = {info.time_base_num, info.time_base_den};
  json["domain"] = {mesh.width, mesh.height};
  json["edge_softness"] = model.edge_softness;
  Json& knots = json["knots"] = Json::array();
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    for (std::uint32_t i = 0; i < instances.multiplicity(k); ++i) {
      knots.push_back({mesh.knots[k].position.x, mesh.knots[k].position.y});
    }
  }
  Json& basis = json["basis"] = Json::array();
  const auto triangles = spline::function_triangles(space);
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    basis.push_back(function_json(model, f, triangles[f], instances));
  }
  Json& features = json["features"] = Json::array();
  for (const mesh::FeatureSegment& s : mesh.segments) {
    Json line = Json::array();
    for (const KnotIndex k : s.knots) line.push_back(instances.first(k));
    features.push_back(std::move(line));
  }
  return json.dump();
}

}  // namespace knotreel::document
