// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/still_document.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "knotreel/document/writer.h"

namespace knotreel::cli {

namespace {

/// What a fit makes of noise that is thousands of times as bright as white may be beyond what a document
/// holds: 2^31 / 255 steps, here of two levels.
document::FrameModel within_bounds(document::FrameModel model) {
  constexpr double kLargest = 16e6;
  for (double& colour : model.colour) colour = std::clamp(colour, -kLargest, kLargest);
  return model;
}

}  // namespace

StillDocument still_document(const image::Image& image, const document::FrameModel& model) {
  document::SequenceInfo info;
  info.width = image.width;
  info.height = image.height;
  info.channels = image.channels;
  info.degree = model.space->degree();
  std::ostringstream bytes;
  document::Writer writer(bytes, info, {.rename_knots = true});
  document::FrameModel stored = writer.append(within_bounds(model));
  writer.finish();
  return {std::move(bytes).str(), std::move(stored)};
}

std::vector<std::string> warnings_of(const vectorize::Report& report) {
  if (!report.features_dropped) return {};
  return {"its features make no mesh that can be stored; it is made without"};
}

}  // namespace knotreel::cli
