#include "knotreel/export/svg.h"
namespace knotreel::exporting {
ExportReport write_svg(const document::FrameModel&, const ExportOptions&, OutputFile&) {
  return {};
}
}  // namespace knotreel::exporting
