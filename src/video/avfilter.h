// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "libav.h"

extern "C" {
#include <libavfilter/avfilter.h>
#include <libavfilter/buffersink.h>
#include <libavfilter/buffersrc.h>
}

#include <string>

namespace knotreel::video {

/// The functions of libavfilter that are used, by their own names.
struct Avfilter {
  decltype(&avfilter_graph_alloc) graph_alloc = nullptr;
  decltype(&avfilter_graph_free) graph_free = nullptr;
  decltype(&avfilter_graph_create_filter) graph_create_filter = nullptr;
  decltype(&avfilter_graph_parse_ptr) graph_parse = nullptr;
  decltype(&avfilter_graph_config) graph_config = nullptr;
  decltype(&avfilter_get_by_name) get_by_name = nullptr;
  decltype(&avfilter_inout_alloc) inout_alloc = nullptr;
  decltype(&avfilter_inout_free) inout_free = nullptr;
  decltype(&av_buffersrc_add_frame) add_frame = nullptr;
  decltype(&av_buffersrc_close) close_source = nullptr;
  decltype(&av_buffersink_get_frame) get_frame = nullptr;
  decltype(&av_buffersink_get_time_base) time_base = nullptr;
  decltype(&av_buffersink_get_frame_rate) frame_rate = nullptr;
};

/// Loads the library with the first video that needs it (docs/decisions/0035-filters.md). Thread-safe.
/// @param why  what is wrong if it cannot be loaded
/// @return null then
const Avfilter* avfilter(std::string& why);

}  // namespace knotreel::video
