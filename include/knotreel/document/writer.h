// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <iosfwd>
#include <memory>

#include "knotreel/base/error.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/document/limits.h"
#include "knotreel/document/sequence_info.h"

namespace knotreel::document {

/// How exactly and how hard to pack. The errors that follow are at most half a step (docs/format.md,
/// "Bounds").
struct EncodeOptions {
  /// Knots lie on a grid of 2^-knot_bits px, kMinKnotBits to kMaxKnotBits; a frame whose faces would flip
  /// takes a finer one.
  int knot_bits = 6;
  /// The same for frames that are no keyframes, where coarser. Moved knots cost two bits per halving.
  int delta_knot_bits = 4;
  /// Of the control colours, in levels of 0..255; 1/256 to 255, taken to the nearest 1/256.
  double colour_step = 2.0;
  /// Step of the colours in frames that are no keyframes, as a multiple of colour_step: 0.5, 1, 1.5, ...
  /// 127.5.
  double delta_coarseness = 1.5;
  /// Of the displacements of geometry control points, in pixels; 1/4096 to 15, taken to the nearest 1/4096.
  double displacement_step = 1 / 16.0;
  /// Give the knots of every keyframe the ids 0, 1, 2, ... in the order of the file, which costs no bytes,
  /// where others cost one to two per knot. For stills, and for encoders that go on from what append()
  /// returns: a later frame of the group must come with those new ids. False keeps all ids as they are.
  bool rename_knots = false;
};

/// Writes a document frame by frame, to a stream and without seeking; the bytes can be read as a document at
/// any time. Not safe to use from several threads.
class Writer {
 public:
  /// @param out must outlive the writer.
  /// @throws Error{kInvalidArgument} for an info or options out of range, Error{kOutput} if writing fails.
  Writer(std::ostream& out, SequenceInfo info, EncodeOptions options = {});

  ~Writer();
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;

  /// Stores a frame; the first is a keyframe whatever the model says.
  /// @return the frame bit by bit as a reader will get it: rounded, and with knots, faces, segments and
  /// functions in the order of the file. An encoder that goes on from it does not drift.
  /// @throws Error{kInvalidArgument} for a model that does not fit the info, is unsound, holds values out
  /// of range or is not later than the frame before (nothing is written then), Error{kOutput} if writing
  /// fails.
  FrameModel append(const FrameModel& model);

  /// Writes the index. Call once, last. @param last_duration  Reader::last_duration() of the document.
  /// @throws Error{kOutput}.
  void finish(std::int64_t last_duration = 0);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace knotreel::document
