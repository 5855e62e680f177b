#include "cli/still_document.h"

#include <sstream>
#include <utility>

#include "knotreel/document/writer.h"

namespace knotreel::cli {

StillDocument still_document(const image::Image& image, const document::FrameModel& model) {
  document::SequenceInfo info;
  info.width = image.width;
  info.height = image.height;
  info.channels = image.channels;
  info.degree = model.space->degree();
  std::ostringstream bytes;
  document::Writer writer(bytes, info, {.rename_knots = true});
  document::FrameModel stored = writer.append(model);
  writer.finish();
  return {std::move(bytes).str(), std::move(stored)};
}

std::vector<std::string> warnings_of(const vectorize::Report& report) {
  if (!report.features_dropped) return {};
  return {"its features make no mesh that can be stored; it is made without"};
}

}  // namespace knotreel::cli
