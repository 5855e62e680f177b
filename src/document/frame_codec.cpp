// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/frame_codec.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "document/bytes.h"
#include "document/canonical.h"
#include "document/colour_coding.h"
#include "document/control_coding.h"
#include "document/identity.h"
#include "document/knot_coding.h"
#include "document/link_coding.h"
#include "document/quantise.h"
#include "document/topology_coding.h"
#include "knotreel/base/error.h"
#include "knotreel/base/ticks.h"
#include "knotreel/document/limits.h"

namespace knotreel::document {
namespace {

constexpr std::uint8_t kKeyframe = 1;
constexpr std::uint8_t kTopology = 2;   ///< stored; else that of the frame before
constexpr std::uint8_t kUnchanged = 4;  ///< nothing else is stored
constexpr std::uint8_t kSoftness = 8;   ///< stored; else that of the frame before, 0 in keyframes

constexpr std::uint8_t kMostSoftness = static_cast<std::uint8_t>(kMostEdgeSoftness / kEdgeSoftnessStep);

FramePrefix read_prefix(ByteReader& in, std::uint8_t& flags) {
  flags = in.u8();
  const bool alone = flags == kUnchanged;
  if ((flags & ~(kKeyframe | kTopology | kSoftness)) != 0 && !alone) malformed("a frame has unknown flags");
  if ((flags & kKeyframe) && !(flags & kTopology)) malformed("a keyframe has no topology");
  FramePrefix prefix;
  prefix.keyframe = flags & kKeyframe;
  prefix.frame = in.varint();
  prefix.pts = in.svarint();
  if (!is_time(prefix.pts)) malformed("the time of a frame is out of range");
  return prefix;
}

bool same_topology(const FrameState& x, const FrameState& y) {
  const mesh::KnotMesh& a = x.mesh();
  const mesh::KnotMesh& b = y.mesh();
  return x.domain_corners == y.domain_corners && a.faces == b.faces &&
         std::ranges::equal(x.space->link_codes(), y.space->link_codes()) &&
         std::ranges::equal(a.knots, b.knots, {}, &mesh::Knot::id, &mesh::Knot::id) &&
         std::ranges::equal(a.segments, b.segments, {}, &mesh::FeatureSegment::knots,
                            &mesh::FeatureSegment::knots);
}

/// The frame before once more, with all that is only there for prediction.
FrameState repeated(const FrameState& before, const FramePrefix& prefix) {
  FrameState state = before;
  state.frame = prefix.frame;
  state.pts = prefix.pts;
  state.keyframe = false;
  return state;
}

/// Matches of a state with the frame before; no knots without one.
Matches match(const FrameState& state, const FrameState* before, bool topology_stored) {
  if (!before) return {std::vector<std::uint32_t>(state.mesh().knots.size(), kNoMatch), {}, {}};
  if (!topology_stored) return identity(state);
  std::vector<std::uint32_t> knots = match_knots(state.mesh(), before->mesh());
  std::vector<std::uint32_t> groups = match_groups(*state.space, *before->space, knots);
  return {std::move(knots), match_functions(*state.space, *before->space), std::move(groups)};
}

void quantise_controls(FrameState& state, const FrameModel& model, const Format& format,
                       const std::vector<spline::FunctionIndex>& function_of) {
  const spline::SplineSpace& given = *model.space;
  const auto channels = static_cast<std::size_t>(format.info.channels);
  const double colour_step = static_cast<double>(state.colour_unit) * format.colour_scale();
  state.colour.reserve(channels * function_of.size());
  state.displacement.resize(2 * state.space->geometry_count());
  for (spline::FunctionIndex f = 0; f < function_of.size(); ++f) {
    for (std::size_t c = 0; c < channels; ++c) {
      state.colour.push_back(state.colour_unit * quantise(model.colour[channels * function_of[f] + c],
                                                          colour_step, "control colour"));
    }
    const Vec2 d = model.displacement[given.geometry_of()[function_of[f]]];
    const std::uint32_t g = state.space->geometry_of()[f];
    state.displacement[2 * g] = quantise(d.x, format.displacement_scale(), "displacement");
    state.displacement[2 * g + 1] = quantise(d.y, format.displacement_scale(), "displacement");
  }
}

void require_fitting(const FrameModel& model, const Format& format) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw Error(ErrorKind::kInvalidArgument, std::string("cannot store a frame: ") + what);
  };
  const std::optional<std::string> defect = find_defect(model);
  if (defect) throw Error(ErrorKind::kInvalidArgument, "cannot store a frame: " + *defect);
  require(model.space->degree() == format.info.degree, "its degree is not that of the document");
  require(model.channels == format.info.channels, "its channels are not those of the document");
  require(model.space->mesh().width == format.info.width && model.space->mesh().height == format.info.height,
          "its size is not that of the document");
  require(is_time(model.pts), "its time is out of range");
}

/// Function ids of a state whose space is set: those of matching functions before, new ones for the rest.
void name_functions(FrameState& state, const FrameState* before, const std::vector<std::uint32_t>& matches) {
  state.next_function_id = before ? before->next_function_id : 0;
  state.function_ids.resize(state.space->function_count());
  for (std::size_t f = 0; f < state.function_ids.size(); ++f) {
    const bool old = before && matches[f] != kNoMatch;
    state.function_ids[f] = old ? before->function_ids[matches[f]] : state.next_function_id++;
  }
}

}  // namespace

bool unchanged(const FrameState& state, const FrameState& before) {
  return state.grid.bits == before.grid.bits && state.edge_softness == before.edge_softness &&
         state.displacement == before.displacement && state.colour == before.colour &&
         std::ranges::equal(state.mesh().knots, before.mesh().knots, {}, &mesh::Knot::position,
                            &mesh::Knot::position) &&
         same_topology(state, before);
}

FrameState to_state(const FrameModel& model, const FrameState* before, const Format& format,
                    const QuantiseOptions& options) {
  require_fitting(model, format);
  FrameState state;
  state.frame = model.frame;
  state.pts = model.pts;
  state.keyframe = before == nullptr;
  state.edge_softness = static_cast<std::uint8_t>(std::lround(model.edge_softness / kEdgeSoftnessStep));
  try {
    CanonicalMesh numbering = canonical_mesh(model.space->mesh());
    state.colour_unit = options.colour_unit;
    state.grid = quantise_knots(numbering, options.knot_bits);
    state.domain_corners = numbering.domain_corners;
    state.discoveries = numbering.conquest.discoveries;
    state.border_count = numbering.border_count;
    mesh::KnotMesh mesh = numbering.mesh;
    if (!before && options.rename_knots) {
      for (std::uint32_t k = 0; k < mesh.knots.size(); ++k) mesh.knots[k].id = KnotId{k};
    }
    state.space = canonical_space(model.space, std::move(mesh), numbering);
    quantise_controls(state, model, format, function_map(*model.space, *state.space, numbering));
  } catch (const Malformed& e) {
    throw Error(ErrorKind::kInvalidArgument, std::string("cannot store a frame: ") + e.what());
  }
  return state;
}

std::vector<std::byte> encode_frame(FrameState& state, const FrameState* before, const Format& format) {
  const bool nothing = before && unchanged(state, *before);
  const bool store_topology = !before || !same_topology(state, *before);
  const bool store_softness = state.edge_softness != (before ? before->edge_softness : 0);
  const auto channels = static_cast<std::size_t>(format.info.channels);
  const mesh::KnotMesh& mesh = state.mesh();

  ByteWriter out;
  out.u8(nothing
             ? kUnchanged
             : static_cast<std::uint8_t>((state.keyframe ? kKeyframe : 0) | (store_topology ? kTopology : 0) |
                                         (store_softness ? kSoftness : 0)));
  out.varint(state.frame);
  out.svarint(state.pts);
  if (nothing) {
    state = repeated(*before, {false, state.frame, state.pts});
    return out.take();
  }
  if (store_softness) out.u8(state.edge_softness);
  out.u8(static_cast<std::uint8_t>(state.grid.bits));
  out.varint(static_cast<std::uint64_t>(state.colour_unit));

  ArithmeticWriter coder;
  FrameModels models = before ? before->models : FrameModels{};
  const Matches matches = match(state, before, store_topology);
  name_functions(state, before, matches.functions);
  if (store_topology) {
    write_topology({mesh, state.discoveries, state.border_count, state.domain_corners, matches.knots}, before,
                   models.topology, coder);
  }
  const KnotLayout layout{mesh, state.discoveries, state.border_count, state.domain_corners};
  KnotCoding(coder, models.positions, layout, PreviousKnots(before, matches.knots, state.grid.bits),
             state.grid, state.history.stays)
      .run();
  if (store_topology) write_links(*state.space, before, models.links, coder);
  code_displacements(coder, models.controls, state, before, matches);
  ColourCoding(coder, models.controls, state, before, matches, channels).run();
  state.models = models;
  out.bytes(coder.finish());

  std::vector<std::byte> payload = out.take();
  const std::size_t knots_before = before ? before->mesh().knots.size() : 0;
  const std::size_t least = mesh.knots.size() - std::min(mesh.knots.size(), knots_before + kFreeKnots);
  if (payload.size() < least) payload.resize(least, std::byte{0});
  return payload;
}

FramePrefix read_prefix(std::span<const std::byte> payload) {
  ByteReader in(payload);
  std::uint8_t flags = 0;
  return read_prefix(in, flags);
}

FrameState decode_frame(std::span<const std::byte> payload, const FrameState* before, const Format& format) {
  ByteReader in(payload);
  std::uint8_t flags = 0;
  const FramePrefix prefix = read_prefix(in, flags);
  FrameState state;
  state.frame = prefix.frame;
  state.pts = prefix.pts;
  state.keyframe = prefix.keyframe;
  if (state.keyframe) before = nullptr;
  if (!state.keyframe && !before) malformed("a frame depends on one before it, but there is none");
  if (flags & kUnchanged) {
    if (std::ranges::any_of(in.take(in.remaining()), [](std::byte b) { return b != std::byte{0}; })) {
      malformed("data after the end of a frame");
    }
    return repeated(*before, prefix);
  }
  state.edge_softness = flags & kSoftness ? in.u8() : before ? before->edge_softness : std::uint8_t{0};
  if (state.edge_softness > kMostSoftness) malformed("edges are softer than allowed");
  state.grid.bits = in.u8();
  if (state.grid.bits > kMaxKnotBits) malformed("the knot grid is finer than allowed");
  state.colour_unit = static_cast<std::int64_t>(in.varint_in(1, kMaxColourUnit, "unit of the colours"));

  ArithmeticReader coder(in.take(in.remaining()));
  if (before) state.models = before->models;
  const bool topology_stored = flags & kTopology;
  Topology topology;
  if (topology_stored) {
    const std::size_t most = (before ? before->mesh().knots.size() : 0) + payload.size() + kFreeKnots;
    topology = read_topology(std::min<std::size_t>(most, std::numeric_limits<KnotIndex>::max() / 32), before,
                             state.models.topology, coder);
  } else {
    topology = {before->mesh(), before->discoveries, before->border_count, before->domain_corners,
                identity(*before).knots};
  }
  topology.mesh.width = format.info.width;
  topology.mesh.height = format.info.height;
  state.border_count = topology.border_count;
  state.domain_corners = topology.domain_corners;
  state.discoveries = std::move(topology.discoveries);
  const std::size_t knots = topology.mesh.knots.size();
  state.grid.points.resize(knots);
  state.grid.parameters.resize(knots);

  const KnotLayout layout{topology.mesh, state.discoveries, state.border_count, state.domain_corners};
  KnotCoding(coder, state.models.positions, layout, PreviousKnots(before, topology.matches, state.grid.bits),
             state.grid, state.history.stays)
      .run();
  set_positions(topology.mesh, state.grid);
  if (const auto defect = mesh::find_defect(topology.mesh)) malformed(*defect);
  if (topology_stored) {
    state.space = read_space(std::move(topology.mesh), format.info.degree, before, state.models.links, coder);
  } else {
    state.space = std::make_shared<spline::SplineSpace>(spline::SplineSpace::from_link_codes(
        std::move(topology.mesh), format.info.degree, before->space->link_codes()));
  }

  const Matches matches = match(state, before, topology_stored);
  const auto channels = static_cast<std::size_t>(format.info.channels);
  state.displacement.resize(2 * state.space->geometry_count());
  state.colour.resize(channels * state.space->function_count());
  code_displacements(coder, state.models.controls, state, before, matches);
  ColourCoding(coder, state.models.controls, state, before, matches, channels).run();
  coder.require_end();
  name_functions(state, before, matches.functions);
  return state;
}

}  // namespace knotreel::document
