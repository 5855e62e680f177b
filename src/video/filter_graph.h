// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "avfilter.h"
#include "libav.h"

namespace knotreel::video {

/// Filters of libavfilter with one input and one output, set up for frames of one size and pixel format.
/// One thread at a time.
class FilterGraph {
 public:
  /// @param text  as `ffmpeg -vf` takes it. @param first  what frames are like.
  /// @param time_base of the times of frames; @param rate of the stream, or 0/1.
  /// @throws Error{kInvalidArgument} if libavfilter is missing, or does not take this.
  FilterGraph(const std::string& text, const AVFrame& first, AVRational time_base, AVRational rate);

  /// Whether a frame is of the size and format that the graph was made for.
  bool takes(const AVFrame& frame) const;

  /// The next frame to be filtered.
  void send(FramePtr frame);

  /// There are no more frames. @param end  of the last one, in ticks of what was sent.
  void close(std::int64_t end);

  /// A filtered frame, its time in ticks of time_base(); null if more has to be sent first, or at the end.
  FramePtr receive();

  AVRational time_base() const { return library_->time_base(sink_); }
  AVRational frame_rate() const { return library_->frame_rate(sink_); }

 private:
  struct Closer {
    const Avfilter* library;
    void operator()(AVFilterGraph* p) const { library->graph_free(&p); }
  };
  void make_ends(const AVFrame& first, AVRational time_base, AVRational rate);
  void parse();
  void check(int result, const LogListener& listener) const;

  std::string text_;
  const Avfilter* library_;
  int width_, height_, format_;
  std::unique_ptr<AVFilterGraph, Closer> graph_;
  AVFilterContext *source_ = nullptr, *sink_ = nullptr;
};

}  // namespace knotreel::video
