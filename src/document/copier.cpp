// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/document/copier.h"

#include <cstdlib>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "document/frame_stream.h"
#include "document/reader_impl.h"
#include "knotreel/base/error.h"
#include "knotreel/base/ticks.h"

namespace knotreel::document {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw Error(ErrorKind::kInvalidArgument, std::string("cannot copy a frame: ") + what);
}

Format copy_format(SequenceInfo info, Steps steps) {
  if (const char* defect = find_defect(info)) throw Error(ErrorKind::kInvalidArgument, defect);
  constexpr std::uint32_t kMost = 65535;
  const auto sound = [](std::uint32_t step) { return step >= 1 && step <= kMost; };
  if (!sound(steps.colour) || !sound(steps.displacement)) {
    throw Error(ErrorKind::kInvalidArgument, "the steps of a document are out of range");
  }
  return {std::move(info), steps.colour, steps.displacement};
}

/// The same values in steps that are `factor` times as fine.
void refine(std::vector<std::int64_t>& values, std::int64_t factor) {
  if (factor == 1) return;
  for (std::int64_t& value : values) {
    require(std::abs(value) <= kMaxControl / factor, "its numbers are too large for steps so fine");
    value *= factor;
  }
}

/// Ids of knots in the order of the file take no bytes.
void rename_knots(FrameState& state) {
  mesh::KnotMesh mesh = state.mesh();
  for (std::uint32_t k = 0; k < mesh.knots.size(); ++k) mesh.knots[k].id = KnotId{k};
  state.space = std::make_shared<spline::SplineSpace>(spline::SplineSpace::from_link_codes(
      std::move(mesh), state.space->degree(), state.space->link_codes()));
}

std::int64_t refinement(std::uint32_t from, std::uint32_t to) {
  require(from % to == 0, "its steps are no multiples of those of the copy");
  return from / to;
}

}  // namespace

Steps common_steps(Steps a, Steps b) {
  return {std::gcd(a.colour, b.colour), std::gcd(a.displacement, b.displacement)};
}

class Copier::Impl {
 public:
  Impl(std::ostream& out, SequenceInfo info, Steps steps)
      : format_(copy_format(std::move(info), steps)), stream_(out, format_) {}

  std::size_t append(DocumentFile& file, std::size_t frame, const Place& place) {
    stream_.require_open();
    check_format(file.format());
    require(is_time(place.pts), "its time is out of range");
    FrameState state = in_our_steps(file.read(frame), file.format());
    state.frame = place.frame;
    state.pts = place.pts;
    const FrameState* before = state_ && place.follows && !state.keyframe ? &*state_ : nullptr;
    state.keyframe = before == nullptr;
    if (state.keyframe && place.rename_knots) rename_knots(state);
    const std::size_t knots = state.mesh().knots.size();
    stream_.put(state, before);
    state_ = std::move(state);
    return knots;
  }

  void finish(std::int64_t last_duration) { stream_.finish(last_duration); }

 private:
  void check_format(const Format& from) const {
    const SequenceInfo& a = from.info;
    const SequenceInfo& b = format_.info;
    require(a.width == b.width && a.height == b.height, "its size is not that of the copy");
    require(a.channels == b.channels, "its channels are not those of the copy");
    require(a.degree == b.degree, "its degree is not that of the copy");
  }

  /// A frame that is still to be coded, on its own or from another one.
  FrameState in_our_steps(FrameState state, const Format& from) const {
    const std::int64_t colours = refinement(from.colour_step, format_.colour_step);
    require(state.colour_unit <= kMaxColourUnit / colours,
            "its steps of colours are too coarse for those of the copy");
    state.colour_unit *= colours;
    refine(state.colour, colours);
    refine(state.displacement, refinement(from.displacement_step, format_.displacement_step));
    return state;
  }

  Format format_;
  FrameStream stream_;
  std::optional<FrameState> state_;  ///< the last frame as written
};

Copier::Copier(std::ostream& out, SequenceInfo info, Steps steps)
    : impl_(std::make_unique<Impl>(out, std::move(info), steps)) {}

Copier::~Copier() = default;
Copier::Copier(Copier&&) noexcept = default;
Copier& Copier::operator=(Copier&&) noexcept = default;

std::size_t Copier::append(Reader& from, std::size_t frame, const Place& place) {
  from.impl_->require_frame(frame);
  return impl_->append(from.impl_->file, frame, place);
}

void Copier::finish(std::int64_t last_duration) {
  impl_->finish(last_duration);
}

}  // namespace knotreel::document
