// SPDX-License-Identifier: GPL-3.0-or-later
#include "avfilter.h"

extern "C" {
#include <libavutil/macros.h>
}

#include "base/loaded_library.h"

namespace knotreel::video {
namespace {

constexpr const char* kLibrary = "libavfilter.so." AV_STRINGIFY(LIBAVFILTER_VERSION_MAJOR);

struct LoadedFilters {
  Avfilter functions;
  std::string why;  ///< empty if all is there
};

LoadedFilters load_filters() {
  LoadedFilters loaded;
  LoadedLibrary library(kLibrary);
  Avfilter& f = loaded.functions;
  library.find("avfilter_graph_alloc", f.graph_alloc);
  library.find("avfilter_graph_free", f.graph_free);
  library.find("avfilter_graph_create_filter", f.graph_create_filter);
  library.find("avfilter_graph_parse_ptr", f.graph_parse);
  library.find("avfilter_graph_config", f.graph_config);
  library.find("avfilter_get_by_name", f.get_by_name);
  library.find("avfilter_inout_alloc", f.inout_alloc);
  library.find("avfilter_inout_free", f.inout_free);
  library.find("av_buffersrc_add_frame", f.add_frame);
  library.find("av_buffersrc_close", f.close_source);
  library.find("av_buffersink_get_frame", f.get_frame);
  library.find("av_buffersink_get_time_base", f.time_base);
  library.find("av_buffersink_get_frame_rate", f.frame_rate);
  loaded.why = library.why();
  return loaded;
}

}  // namespace

const Avfilter* avfilter(std::string& why) {
  static const LoadedFilters loaded = load_filters();
  why = loaded.why;
  return loaded.why.empty() ? &loaded.functions : nullptr;
}

}  // namespace knotreel::video
