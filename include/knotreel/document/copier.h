// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>

#include "knotreel/base/error.h"
#include "knotreel/document/reader.h"
#include "knotreel/document/sequence_info.h"

namespace knotreel::document {

/// The largest steps that numbers of both documents are whole multiples of.
Steps common_steps(Steps a, Steps b);

/// Writes frames of documents into another one without loss: all numbers stay as they are. As Writer, to a
/// stream and without seeking. Not safe to use from several threads.
class Copier {
 public:
  /// Where a frame comes in the copy.
  struct Place {
    std::uint64_t frame = 0;  ///< FrameModel::frame
    std::int64_t pts = 0;     ///< FrameModel::pts, in the time base of the copy
    /// The frame copied last is the one before in the same document, so that a frame that is stored as what
    /// has changed since then is stored so again. Others become keyframes.
    bool follows = false;
    /// Of a frame that becomes a keyframe: as EncodeOptions::rename_knots. None can follow it.
    bool rename_knots = false;
  };

  /// @param out must outlive the copier. @param steps  of the copy, which divide those of the documents.
  /// @throws Error{kInvalidArgument} for an info or steps out of range, Error{kOutput} if writing fails.
  Copier(std::ostream& out, SequenceInfo info, Steps steps);

  ~Copier();
  Copier(Copier&&) noexcept;
  Copier& operator=(Copier&&) noexcept;

  /// Copies a frame. @param frame  place in the document, from 0.
  /// @return number of its knots.
  /// @throws Error{kInvalidArgument} if there is no such frame, or if it does not fit: another size, degree
  /// or number of channels, or steps that those of the copy do not divide, or a time that is not after that
  /// of the frame before (nothing is written then);
  /// Error{kInput} if it is damaged, Error{kOutput} if writing fails.
  std::size_t append(Reader& from, std::size_t frame, const Place& place);

  /// Writes the index. Call once, last. @param last_duration  Reader::last_duration() of the document.
  /// @throws Error{kOutput}.
  void finish(std::int64_t last_duration = 0);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace knotreel::document
