// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/document/reader.h"
#include "knotreel/document/sequence_info.h"
#include "knotreel/video/stream_info.h"

/// Which frames of which documents become a new document, and when each is shown.
namespace knotreel::pipeline {

/// What has to be known of a document before it is copied.
struct Contents {
  std::string name;  ///< for messages
  document::SequenceInfo info;
  document::Steps steps;
  std::vector<std::int64_t> times;  ///< of its frames, in its time base
  std::int64_t last_duration = 0;   ///< of its last frame, likewise; 0: not known
};

/// What plan_copy() wants to know of a document; no frame is read.
/// @param name  of the document, for messages.
Contents contents_of(const document::Reader& reader, std::string name);

struct CopiedFrame {
  std::size_t document = 0;  ///< place in the list of documents
  std::size_t frame = 0;     ///< place in that document
  std::int64_t pts = 0;      ///< in the time base of the copy
};

struct CopyPlan {
  document::SequenceInfo info;  ///< of the copy
  document::Steps steps;
  std::vector<CopiedFrame> frames;
  std::int64_t end = 0;               ///< of the last frame, in the time base of the copy
  std::vector<std::string> warnings;  ///< one line each
};

/// All frames of all documents, one document after the other. Each begins where the one before ends, unless
/// both were parts of one (their heads are the same) and it is later anyhow: so the documents that a video
/// was split into keep their times.
/// @param documents  at least one.
/// @param rate  of documents that do not say how long their frames last, such as those of pictures.
/// @throws Error{kInvalidArgument} naming the document if one is of another size, degree or number of
/// channels than the first one, or shown otherwise; also if their units of time have no common one, or times
/// become too large.
CopyPlan plan_copy(const std::vector<Contents>& documents, video::Rational rate);

/// Only these frames, both ends included, beginning at zero unless they begin with the first.
/// @pre first <= last < plan.frames.size().
CopyPlan part_of(CopyPlan plan, std::size_t first, std::size_t last);

}  // namespace knotreel::pipeline
