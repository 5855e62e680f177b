#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "source.h"

namespace knotreel::video {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

/// Some of the frames of another source, and the packets of the time in which they are shown.
class PartSource : public Source {
 public:
  PartSource(std::unique_ptr<Source> whole, std::uint64_t first, std::uint64_t count)
      : whole_(std::move(whole)), count_(count) {
    info_ = whole_->info();
    pass_over(first);
    ahead_ = read();
    if (!ahead_) {
      throw Error(ErrorKind::kInvalidArgument, "there is no frame " + std::to_string(first) +
                                                   ": the video has " + std::to_string(passed_over_) +
                                                   ", the first of which is 0");
    }
    describe(first);
  }

  bool next(Frame& frame) override {
    if (!ahead_) return false;
    frame = std::move(*ahead_);
    ahead_.reset();
    frame.index = handed_out_++;
    end_ = count_ > 0 ? seconds_of(frame.pts + frame.duration) : kForever;
    hold(std::move(frame.packets));
    frame.packets = shown();
    if (handed_out_ != count_) ahead_ = read();
    return true;
  }

  std::vector<Packet> take_packets() override {
    const bool is_whole_part = count_ > 0 && handed_out_ == count_;
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

  std::optional<Frame> read() {
    Frame frame;
    if (!whole_->next(frame)) return {};
    return frame;
  }

  /// What belongs to the frames before the part goes; so does what is held, lest it grow.
  void pass_over(std::uint64_t frames) {
    for (; passed_over_ < frames; ++passed_over_) {
      check_while_working();
      Frame frame;
      if (!whole_->skip(frame)) return;
      begin_ = seconds_of(frame.pts + frame.duration);
      hold(std::move(frame.packets));
    }
  }

  void describe(std::uint64_t first) {
    const double rate = info_.frames > 0 ? static_cast<double>(info_.frames) / info_.seconds : 0;
    info_.frames -= std::min(info_.frames, first);
    if (count_ > 0) {
      info_.frames = info_.frames > 0 ? std::min(info_.frames, count_) : count_;
      info_.end = 0;
    }
    info_.seconds = rate > 0 ? static_cast<double>(info_.frames) / rate : 0;
    if (first == 0) return;
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
  std::uint64_t count_;  ///< of frames, at most; 0: up to the end
  std::uint64_t passed_over_ = 0;
  std::uint64_t handed_out_ = 0;
  std::optional<Frame> ahead_;
  double begin_ = -kForever;  ///< of the packets that are handed out, seconds on the clock of the file
  double end_ = kForever;     ///< of those handed out by now
  std::vector<Packet> held_;
};

}  // namespace

std::unique_ptr<Source> open_part(std::unique_ptr<Source> whole, std::uint64_t first, std::uint64_t count) {
  return std::make_unique<PartSource>(std::move(whole), first, count);
}

}  // namespace knotreel::video
