// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "knotreel/image/image.h"
#include "knotreel/video/reader.h"

namespace knotreel::cli {

/// Frames of a video, or of a document, which are drawn at their own size, as players show them: turned, if
/// the video says so. One thread at a time.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// False at the end.
  virtual bool next(image::Image& image) = 0;
  /// What was wrong without being an error, one line each.
  virtual std::vector<std::string> warnings() const { return {}; }
};

/// Whether a file begins as documents do, or what is to come from standard input. Named pipes, which cannot
/// be looked at, do not.
bool is_document(const std::string& path);

/// Whether these are the first bytes of one, or all.
bool begins_document(std::span<const std::byte> bytes);

/// Whether a file holds several frames: a video, or a document with more than one.
bool has_frames(const std::string& path);

/// @param options  of a video; documents need none
/// @throws Error{kInput} if it is neither video nor document.
std::unique_ptr<FrameSource> open_frames(const std::string& path, const video::ReadOptions& options);

}  // namespace knotreel::cli
