// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "source.h"

namespace knotreel::video {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kMostFrames = 1e15;  // that an estimate may come to
constexpr double kSameTime = 1e-6;    // seconds; times are told with less than that

/// Some of the frames of another source, and the packets of the time in which they are shown.
class PartSource : public Source {
 public:
  PartSource(std::unique_ptr<Source> whole, const Part& part) : whole_(std::move(whole)), part_(part) {
    info_ = whole_->info();
    pass_over();
    ahead_ = read();
    if (!ahead_) refuse();
    describe();
  }

  bool next(Frame& frame) override {
    if (!ahead_) return false;
    frame = std::move(*ahead_);
    ahead_.reset();
    frame.index = handed_out_++;
    end_ = has_end() ? seconds_of(frame.pts + frame.duration) : kForever;
    hold(std::move(frame.packets));
    frame.packets = shown();
    if (handed_out_ != part_.count) ahead_ = read();
    return true;
  }

  std::vector<Packet> take_packets() override {
    const bool is_whole_part = ended_ || (part_.count > 0 && handed_out_ == part_.count);
    if (!is_whole_part) end_ = kForever;
    hold(is_whole_part ? whole_->packets_until(end_) : whole_->take_packets());
    return shown();
  }
  std::vector<Packet> packets_until(double seconds) override {
    hold(whole_->packets_until(seconds));
    return shown();
  }

  AVFormatContext* format() const override { return whole_->format(); }
  int video_stream() const override { return whole_->video_stream(); }
  std::vector<int> copied_streams() const override { return whole_->copied_streams(); }
  const Warnings& warnings() const override { return whole_->warnings(); }
  std::uint64_t damaged() const override { return whole_->damaged(); }

 private:
  double seconds_of(std::int64_t pts) const { return static_cast<double>(pts) * info_.time_base.value(); }

  bool has_end() const { return part_.count > 0 || part_.end < kForever; }

  /// Nothing behind the last frame, or if the next one is not of the part any more.
  std::optional<Frame> read() {
    Frame frame;
    if (ended_ || !whole_->next(frame)) return {};
    if (!zero_) zero_ = seconds_of(frame.pts);
    if (seconds_of(frame.pts) - *zero_ < part_.end - kSameTime) return frame;
    ended_ = true;
    hold(std::move(frame.packets));
    return {};
  }

  /// What belongs to the frames before the part goes; so does what is held, lest it grow.
  void pass_over() {
    while (passed_over_ < part_.first || length_before_ < part_.start - kSameTime) {
      check_while_working();
      Frame frame;
      if (!whole_->skip(frame)) return;
      const bool is_first = !zero_;
      if (is_first) zero_ = seconds_of(frame.pts);
      begin_ = seconds_of(frame.pts + frame.duration);
      length_before_ = begin_ - *zero_;
      hold(std::move(frame.packets));
      ++passed_over_;
      if (is_first && part_.first == 0 && whole_->seek(*zero_ + part_.start)) has_sought_ = true;
    }
  }

  [[noreturn]] void refuse() const {
    const auto seconds = [](double s) {
      std::ostringstream text;
      text << s << " s";
      return text.str();
    };
    std::string what = "there is no frame ";
    if (ended_) {
      what += "from " + seconds(part_.start) + " to " + seconds(part_.end);
    } else if (part_.start > 0) {
      what += "from " + seconds(part_.start) + " on: the video ends after " + seconds(length_before_);
    } else {
      what += std::to_string(part_.first) + ": the video has " + std::to_string(passed_over_) +
              ", the first of which is 0";
    }
    throw Error(ErrorKind::kInvalidArgument, what);
  }

  void describe() {
    const bool is_known = info_.frames > 0 && info_.seconds > 0;
    const double rate = is_known ? static_cast<double>(info_.frames) / info_.seconds : 0;
    const auto frames_in = [&](double seconds) {
      return static_cast<std::uint64_t>(std::min(kMostFrames, std::round(seconds * rate)));
    };
    if (has_sought_) passed_over_ = frames_in(length_before_);
    info_.frames -= std::min(info_.frames, passed_over_);
    std::uint64_t most = part_.count;
    if (part_.end < kForever && rate > 0) {
      const std::uint64_t there = frames_in(part_.end - part_.start);
      most = std::max<std::uint64_t>(1, most > 0 ? std::min(most, there) : there);
    }
    if (most > 0) info_.frames = info_.frames > 0 ? std::min(info_.frames, most) : most;
    if (has_end()) info_.end = 0;
    info_.seconds = rate > 0 ? static_cast<double>(info_.frames) / rate : 0;
    if (passed_over_ == 0) return;
    info_.start = ahead_->pts;
    begin_ = seconds_of(ahead_->pts);
  }

  /// Keeps packets that are not of an earlier time than the part; those without a time only behind its start.
  void hold(std::vector<Packet> packets) {
    std::move(packets.begin(), packets.end(), std::back_inserter(held_));
    std::erase_if(held_, [&](const Packet& p) {
      return p.seconds() < begin_ || (handed_out_ == 0 && begin_ > -kForever && !(p.seconds() >= begin_));
    });
  }

  /// Hands out those before the end of what has been shown.
  std::vector<Packet> shown() {
    const auto later = std::stable_partition(held_.begin(), held_.end(),
                                             [&](const Packet& p) { return !(p.seconds() >= end_); });
    std::vector<Packet> packets(std::move_iterator(held_.begin()), std::move_iterator(later));
    held_.erase(held_.begin(), later);
    return packets;
  }

  std::unique_ptr<Source> whole_;
  Part part_;
  bool ended_ = false;          ///< the frame behind the part has been met
  std::optional<double> zero_;  ///< time of the first frame of the whole, seconds on the clock of the file
  std::uint64_t passed_over_ = 0;
  double length_before_ = 0;  ///< of the frames before the part, seconds
  bool has_sought_ = false;   ///< so not all of them have been counted
  std::uint64_t handed_out_ = 0;
  std::optional<Frame> ahead_;
  double begin_ = -kForever;  ///< of the packets that are handed out, seconds on the clock of the file
  double end_ = kForever;     ///< of those handed out by now
  std::vector<Packet> held_;
};

}  // namespace

std::unique_ptr<Source> open_part(std::unique_ptr<Source> whole, const Part& part) {
  return std::make_unique<PartSource>(std::move(whole), part);
}

}  // namespace knotreel::video
