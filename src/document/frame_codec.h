// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "document/frame_state.h"

/// Frames to payloads and back, without container and checksum (docs/format.md, "Frame").
namespace knotreel::document {

/// A frame may have as many knots as the frame before plus one per byte of its payload, and four more; the
/// writer pads where needed. So the knots of a document never outnumber its bytes.
inline constexpr std::size_t kFreeKnots = 4;

/// What the index also holds of a frame.
struct FramePrefix {
  bool keyframe = false;
  std::uint64_t frame = 0;
  std::int64_t pts = 0;
};

struct QuantiseOptions {
  int knot_bits = 6;
  std::int64_t colour_unit = 1;
  bool rename_knots = false;
};

/// Brings a model into the form of the file, but for what encode_frame() sets.
/// @param before  null makes a keyframe.
/// @throws Error{kInvalidArgument} for a model that cannot be stored.
FrameState to_state(const FrameModel& model, const FrameState* before, const Format& format,
                    const QuantiseOptions& options);

/// Whether a frame is the one before but for its number and time.
bool unchanged(const FrameState& state, const FrameState& before);

/// @param before  as given to to_state.
/// @param state   what to_state() left out is set.
std::vector<std::byte> encode_frame(FrameState& state, const FrameState* before, const Format& format);

FramePrefix read_prefix(std::span<const std::byte> payload);

/// Decodes a payload that may be hostile; all that it returns is sound.
/// @param before  the frame before in the file; may be null for a keyframe.
/// @throws Malformed or Error{kInput}.
FrameState decode_frame(std::span<const std::byte> payload, const FrameState* before, const Format& format);

}  // namespace knotreel::document
