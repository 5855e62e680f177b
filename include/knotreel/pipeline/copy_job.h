// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "knotreel/base/error.h"
#include "knotreel/document/reader.h"
#include "knotreel/pipeline/copy_plan.h"
#include "knotreel/pipeline/job.h"

namespace knotreel::pipeline {

/// Documents that become one, or one each frame, without loss.
struct CopyJob {
  CopyPlan plan;
  /// Opens a document of the list that the plan was made from; called in order, for each that is copied from.
  std::function<document::Reader(std::size_t document)> open;
  std::string document;      ///< to write; `-`: standard output; empty: none
  std::string split_folder;  ///< as Job::split_folder
  Stop stop;
  FrameObserver on_frame;  ///< figures other than index, times, knots and bytes of the document are 0
};

struct CopySummary {
  std::uint64_t frames = 0;
  std::uint64_t document_bytes = 0;  ///< of Job::document, all in
  bool stopped = false;              ///< by the caller, before the last frame; what was written is whole
};

/// @throws Error{kInput} if a document is damaged or not what it was when the plan was made, Error{kOutput}
/// if writing fails; nothing is left then, but for single frames that were whole.
CopySummary run_copy(const CopyJob& job);

}  // namespace knotreel::pipeline
