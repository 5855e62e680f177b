#include "avfilter.h"

#include <dlfcn.h>

extern "C" {
#include <libavutil/macros.h>
}

#include <type_traits>

namespace knotreel::video {
namespace {

constexpr const char* kLibrary = "libavfilter.so." AV_STRINGIFY(LIBAVFILTER_VERSION_MAJOR);

struct LoadedFilters {
  Avfilter functions;
  std::string why;  ///< empty if all is there
};

LoadedFilters load_filters() {
  LoadedFilters loaded;
  void* library = ::dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* error = ::dlerror();
    loaded.why = error == nullptr ? std::string("cannot load ") + kLibrary : error;
    return loaded;
  }
  const auto find = [&](const char* name, auto& function) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
    if (function == nullptr) loaded.why = std::string("no ") + name + " in " + kLibrary;
  };
  Avfilter& f = loaded.functions;
  find("avfilter_graph_alloc", f.graph_alloc);
  find("avfilter_graph_free", f.graph_free);
  find("avfilter_graph_create_filter", f.graph_create_filter);
  find("avfilter_graph_parse_ptr", f.graph_parse);
  find("avfilter_graph_config", f.graph_config);
  find("avfilter_get_by_name", f.get_by_name);
  find("avfilter_inout_alloc", f.inout_alloc);
  find("avfilter_inout_free", f.inout_free);
  find("av_buffersrc_add_frame", f.add_frame);
  find("av_buffersink_get_frame", f.get_frame);
  find("av_buffersink_get_time_base", f.time_base);
  find("av_buffersink_get_frame_rate", f.frame_rate);
  return loaded;
}

}  // namespace

const Avfilter* avfilter(std::string& why) {
  static const LoadedFilters loaded = load_filters();
  why = loaded.why;
  return loaded.why.empty() ? &loaded.functions : nullptr;
}

}  // namespace knotreel::video
