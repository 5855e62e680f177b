// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/document/writer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "document/container.h"
#include "document/frame_codec.h"
#include "document/frame_stream.h"
#include "knotreel/base/error.h"

namespace knotreel::document {
namespace {

// The step of the file is half that of keyframes, so that deltas can have steps of one and a half.
constexpr std::int64_t kKeyframeUnit = 2;

std::int64_t delta_unit(const EncodeOptions& options) {
  const double unit = std::round(kKeyframeUnit * options.delta_coarseness);
  if (!(unit >= 1 && unit <= kMaxColourUnit)) {
    throw Error(ErrorKind::kInvalidArgument, "the coarseness of deltas of a document is out of range");
  }
  return static_cast<std::int64_t>(unit);
}

std::uint32_t units(double step, double per_unit, const char* name) {
  const double n = std::round(step * per_unit);
  if (!(n >= 1 && n <= 65535)) {
    throw Error(ErrorKind::kInvalidArgument,
                std::string("the ") + name + " step of a document is out of range");
  }
  return static_cast<std::uint32_t>(n);
}

Format make_format(SequenceInfo info, const EncodeOptions& options) {
  if (const char* defect = find_defect(info)) throw Error(ErrorKind::kInvalidArgument, defect);
  if (options.knot_bits < kMinKnotBits || options.knot_bits > kMaxKnotBits) {
    throw Error(ErrorKind::kInvalidArgument, "the knot bits of a document are 0 to 14");
  }
  if (options.delta_knot_bits < kMinKnotBits || options.delta_knot_bits > kMaxKnotBits) {
    throw Error(ErrorKind::kInvalidArgument, "the knot bits of a document are 0 to 14");
  }
  return {std::move(info), units(options.colour_step, kColourUnits / kKeyframeUnit, "colour"),
          units(options.displacement_step, kDisplacementUnits, "displacement")};
}

}  // namespace

class Writer::Impl {
 public:
  Impl(std::ostream& out, SequenceInfo info, const EncodeOptions& options)
      : format_(make_format(std::move(info), options)),
        keyframes_{options.knot_bits, kKeyframeUnit, options.rename_knots},
        deltas_{std::min(options.knot_bits, options.delta_knot_bits), delta_unit(options), false},
        stream_(out, format_) {}

  FrameModel append(const FrameModel& model) {
    stream_.require_open();
    const FrameState* before = state_ && !model.keyframe ? &*state_ : nullptr;
    FrameState state = next_state(model, before);
    stream_.put(state, before);
    state_ = std::move(state);
    return to_model(*state_, format_);
  }

  void finish(std::int64_t last_duration) { stream_.finish(last_duration); }

 private:
  /// Deltas have coarser steps than the keyframe before them, but what repeats it stays as it is.
  FrameState next_state(const FrameModel& model, const FrameState* before) const {
    if (!before) return to_state(model, before, format_, keyframes_);
    QuantiseOptions steps = deltas_;
    if (model.colour_step > 0) {
      steps.colour_unit = std::clamp<std::int64_t>(std::llround(model.colour_step / format_.colour_scale()),
                                                   1, kMaxColourUnit);
    }
    if (before->grid.bits > steps.knot_bits || before->colour_unit < steps.colour_unit) {
      FrameState same = to_state(model, before, format_, {before->grid.bits, before->colour_unit, false});
      if (unchanged(same, *before)) return same;
    }
    return to_state(model, before, format_, steps);
  }

  Format format_;
  QuantiseOptions keyframes_;
  QuantiseOptions deltas_;
  FrameStream stream_;
  std::optional<FrameState> state_;  ///< the last frame as written
};

Writer::Writer(std::ostream& out, SequenceInfo info, EncodeOptions options)
    : impl_(std::make_unique<Impl>(out, std::move(info), options)) {}

Writer::~Writer() = default;
Writer::Writer(Writer&&) noexcept = default;
Writer& Writer::operator=(Writer&&) noexcept = default;

FrameModel Writer::append(const FrameModel& model) {
  return impl_->append(model);
}
void Writer::finish(std::int64_t last_duration) {
  impl_->finish(last_duration);
}

}  // namespace knotreel::document
