// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_graph.h"

#include "knotreel/base/error.h"

namespace knotreel::video {
namespace {

const Avfilter* needed_library(const std::string& text) {
  std::string why;
  const Avfilter* library = avfilter(why);
  if (library == nullptr)
    throw Error(ErrorKind::kInvalidArgument, "cannot filter with '" + text + "': " + why);
  return library;
}

std::string ratio(AVRational value) {
  return std::to_string(value.num) + "/" + std::to_string(value.den);
}

/// One open end of a graph, for the parser, which may free it or put others in its place.
class OpenEnd {
 public:
  OpenEnd(const Avfilter& library, const char* name, AVFilterContext* filter)
      : library_(library), end_(allocated(library.inout_alloc())) {
    end_->name = allocated(av_strdup(name));
    end_->filter_ctx = filter;
    end_->pad_idx = 0;
    end_->next = nullptr;
  }
  ~OpenEnd() { library_.inout_free(&end_); }
  OpenEnd(const OpenEnd&) = delete;
  OpenEnd& operator=(const OpenEnd&) = delete;

  AVFilterInOut** get() { return &end_; }

 private:
  const Avfilter& library_;
  AVFilterInOut* end_;
};

}  // namespace

FilterGraph::FilterGraph(const std::string& text, const AVFrame& first, AVRational time_base, AVRational rate)
    : text_(text),
      library_(needed_library(text)),
      width_(first.width),
      height_(first.height),
      format_(first.format),
      graph_(allocated(library_->graph_alloc()), Closer{library_}) {
  // Decoding is one of several stages that run at once.
  graph_->nb_threads = 1;
  make_ends(first, time_base, rate);
  parse();
}

void FilterGraph::check(int result, const LogListener& listener) const {
  if (result == AVERROR(ENOMEM)) throw std::bad_alloc();
  if (result >= 0) return;
  throw Error(ErrorKind::kInvalidArgument,
              "cannot filter with '" + text_ +
                  "': " + (listener.first_error().empty() ? error_text(result) : listener.first_error()));
}

void FilterGraph::make_ends(const AVFrame& first, AVRational time_base, AVRational rate) {
  const AVRational aspect = first.sample_aspect_ratio;
  std::string shape = "video_size=" + std::to_string(width_) + "x" + std::to_string(height_) +
                      ":pix_fmt=" + std::to_string(format_) + ":time_base=" + ratio(time_base);
  if (aspect.num > 0 && aspect.den > 0) shape += ":pixel_aspect=" + ratio(aspect);
  if (rate.num > 0 && rate.den > 0) shape += ":frame_rate=" + ratio(rate);
  const LogListener listener;
  check(library_->graph_create_filter(&source_, library_->get_by_name("buffer"), "in", shape.c_str(), nullptr,
                                      graph_.get()),
        listener);
  check(library_->graph_create_filter(&sink_, library_->get_by_name("buffersink"), "out", nullptr, nullptr,
                                      graph_.get()),
        listener);
}

void FilterGraph::parse() {
  OpenEnd begin(*library_, "in", source_);
  OpenEnd end(*library_, "out", sink_);
  const LogListener listener;
  check(library_->graph_parse(graph_.get(), text_.c_str(), end.get(), begin.get(), nullptr), listener);
  check(library_->graph_config(graph_.get(), nullptr), listener);
}

bool FilterGraph::takes(const AVFrame& frame) const {
  return frame.width == width_ && frame.height == height_ && frame.format == format_;
}

void FilterGraph::send(FramePtr frame) {
  const LogListener listener;
  check(library_->add_frame(source_, frame.get()), listener);
}

void FilterGraph::close(std::int64_t end) {
  const LogListener listener;
  check(library_->close_source(source_, end, 0), listener);
}

FramePtr FilterGraph::receive() {
  FramePtr frame = new_frame();
  const LogListener listener;
  const int result = library_->get_frame(sink_, frame.get());
  if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return {};
  check(result, listener);
  return frame;
}

}  // namespace knotreel::video
