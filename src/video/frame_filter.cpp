// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame_filter.h"

#include <utility>

#include "colour_rules.h"
#include "knotreel/base/error.h"

namespace knotreel::video {
namespace {

/// Motion adaptive, from three frames [bwdif]: what rests keeps all of its lines.
std::string deinterlacer(Deinterlace mode) {
  switch (mode) {
    case Deinterlace::kNone:
      return "";
    case Deinterlace::kMarked:
      return "bwdif=mode=send_frame:deint=interlaced";
    case Deinterlace::kAll:
      return "bwdif=mode=send_frame:deint=all";
    case Deinterlace::kFields:
      return "bwdif=mode=send_field:deint=all";
  }
  return "";
}

std::string in_a_row(const std::string& first, const std::string& second) {
  return first.empty() || second.empty() ? first + second : first + "," + second;
}

}  // namespace

FrameFilter::FrameFilter(const ReadOptions& options, const StreamInfo& stream, Warnings& warnings)
    : mode_(options.deinterlace),
      filter_(options.filter),
      sent_time_base_(to_av(stream.time_base)),
      time_base_(sent_time_base_),
      sent_rate_(to_av(stream.frame_rate)),
      rate_(sent_rate_),
      sent_aspect_(to_av(stream.sample_aspect)),
      warnings_(warnings) {}

/// What a frame has to go through; empty if it can pass as it is. Two moments for each frame are another
/// clock, so they have their deinterlacer from the first frame on.
std::string FrameFilter::filters_for(const AVFrame& frame) const {
  const bool is_whole = mode_ == Deinterlace::kMarked && frame.interlaced_frame == 0;
  if (given_up_ || is_whole) return filter_;
  return in_a_row(deinterlacer(mode_), filter_);
}

/// What only the container tells, and what follows from the size, which filters change.
void FrameFilter::complete(AVFrame& frame) const {
  frame.sample_aspect_ratio = sent_aspect_;
  const AVPixFmtDescriptor& format = *av_pix_fmt_desc_get(AVPixelFormat(frame.format));
  if (frame.colorspace == AVCOL_SPC_UNSPECIFIED && !is_rgb(format) && !is_grey(format))
    frame.colorspace = AVColorSpace(matrix_in_use(frame.colorspace, frame.height));
}

void FrameFilter::set_up(const AVFrame& frame, const std::string& filters) {
  try {
    graph_.emplace(filters, frame, sent_time_base_, sent_rate_);
  } catch (const Error& e) {
    if (mode_ != Deinterlace::kMarked || filters == filter_) throw;
    // Nobody has asked for it, so it is no reason to end.
    given_up_ = true;
    warnings_.add(std::string("interlaced frames are left as they are: ") + e.what());
    if (!filter_.empty()) set_up(frame, filter_);
    return;
  }
  // One clock for all of the video, whatever the frames behind the first are like.
  if (!changes_times() || std::exchange(has_clock_, true)) return;
  time_base_ = graph_->time_base();
  rate_ = graph_->frame_rate();
}

void FrameFilter::send(FramePtr frame) {
  if (!frame) {
    drain(sent_end_);
    return;
  }
  sent_end_ = end_of(*frame);
  const bool is_interlaced = frame->interlaced_frame != 0 && mode_ != Deinterlace::kNone;
  const bool lacks_deinterlacer = is_interlaced && !deinterlaces_ && !given_up_;
  if (graph_ && (!graph_->takes(*frame) || lacks_deinterlacer)) drain(frame->pts);
  const std::string filters = filters_for(*frame);
  if (graph_ || !filters.empty()) complete(*frame);
  if (!graph_ && !filters.empty()) {
    set_up(*frame, filters);
    deinterlaces_ = filters != filter_;
  }
  if (!graph_) {
    ready_.push_back(std::move(frame));
    return;
  }
  if (is_interlaced && !given_up_) warnings_.count("frames are interlaced, and deinterlaced");
  graph_->send(std::move(frame));
}

/// In ticks of what is sent.
std::int64_t FrameFilter::end_of(const AVFrame& frame) const {
  if (frame.pkt_duration > 0 && is_time(frame.pkt_duration)) return frame.pts + frame.pkt_duration;
  if (sent_rate_.num <= 0) return frame.pts;
  return frame.pts + av_rescale_q(1, av_inv_q(sent_rate_), sent_time_base_);
}

/// Takes what the graph still has, and leaves it. Filters that make a rate of their own show its last frame
/// up to the end.
void FrameFilter::drain(std::int64_t end) {
  if (!graph_) return;
  graph_->close(end);
  while (FramePtr frame = from_graph()) ready_.push_back(std::move(frame));
  graph_.reset();
}

FramePtr FrameFilter::from_graph() {
  FramePtr frame = graph_->receive();
  if (!frame) return {};
  const std::int64_t earliest = last_pts_ == AV_NOPTS_VALUE ? 0 : last_pts_ + 1;
  std::int64_t pts = earliest;
  if (frame->pts != AV_NOPTS_VALUE) pts = av_rescale_q(frame->pts, graph_->time_base(), time_base_);
  if (last_pts_ != AV_NOPTS_VALUE && pts < earliest) {
    pts = earliest;
    warnings_.count("frames go back in time behind the filters; they are put after the frame before");
  }
  if (!is_time(pts))
    throw Error(ErrorKind::kInvalidArgument, "'" + filter_ + "' makes times that are out of range");
  frame->pts = last_pts_ = pts;
  // What stands there is of the frames before the filters.
  if (changes_times()) frame->pkt_duration = 0;
  return frame;
}

FramePtr FrameFilter::receive() {
  if (!ready_.empty()) {
    FramePtr frame = std::move(ready_.front());
    ready_.pop_front();
    return frame;
  }
  return graph_ ? from_graph() : FramePtr();
}

void FrameFilter::reset() {
  graph_.reset();
  ready_.clear();
  last_pts_ = AV_NOPTS_VALUE;
}

}  // namespace knotreel::video
