// SPDX-License-Identifier: GPL-3.0-or-later
#include "joined_times.h"

#include <algorithm>

namespace knotreel::video {
namespace {

constexpr std::int64_t kSecond = AV_TIME_BASE;
/// Clocks of damaged or badly made files tremble, and libav guesses times of decoding that are not told.
constexpr std::int64_t kLeastStep = kSecond / 2;
/// Of times and steps, some thousand years: sums of those stay whole.
constexpr std::int64_t kFarthest = std::int64_t{1} << 57;

bool is_near(std::int64_t microseconds) {
  return microseconds > -kFarthest && microseconds < kFarthest;
}

/// libav takes a clock that is behind its start for one that has run over, and adds all that it can count.
std::int64_t run_over(const AVStream& stream) {
  if (stream.pts_wrap_bits <= 0 || stream.pts_wrap_bits > 62) return 0;
  return av_rescale_q(std::int64_t{1} << stream.pts_wrap_bits, stream.time_base, AV_TIME_BASE_Q);
}

}  // namespace

/// By its place in the file if that is known: what was begun before a joint may come behind it.
std::size_t JoinedTimes::part_of(const AVPacket& packet, const AVStream& stream, const Clock& clock,
                                 std::int64_t time) {
  const std::size_t last = parts_.size() - 1;
  Part& newest = parts_[last];
  const bool is_behind_joint = newest.begin >= 0 && packet.pos >= newest.begin;
  if (clock.part < last && is_behind_joint) return last;
  const std::int64_t late = time + parts_[clock.part].step - clock.now;
  const std::int64_t most = run_over(stream) / 2;
  if (late >= -kLeastStep && (most == 0 || late < most)) return clock.part;
  if (clock.part < last) {
    newest.begin = std::min(newest.begin, packet.pos);
    return last;
  }
  const std::int64_t step = std::max(end_, clock.now + clock.duration) - time;
  if (!is_near(step)) return clock.part;
  parts_.push_back({step, packet.pos});
  return last + 1;
}

void JoinedTimes::move(AVPacket& packet, const AVStream& stream) {
  // In the order of decoding, the times at which pictures are shown go up and down.
  const bool is_video = stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO;
  const std::int64_t told = packet.dts != AV_NOPTS_VALUE || is_video ? packet.dts : packet.pts;
  const auto [found, is_first] = clocks_.try_emplace(packet.stream_index, Clock{parts_.size() - 1});
  Clock& clock = found->second;
  const std::int64_t time = is_time(told) ? av_rescale_q(told, stream.time_base, AV_TIME_BASE_Q) : kFarthest;
  if (is_near(time)) {
    if (!is_first) clock.part = part_of(packet, stream, clock, time);
    clock.now = time + parts_[clock.part].step;
    // Guesses, where pictures come as they like.
    clock.duration =
        std::clamp<std::int64_t>(av_rescale_q(packet.duration, stream.time_base, AV_TIME_BASE_Q), 0, kSecond);
    end_ = std::max(end_, clock.now);
  }
  const std::int64_t step = av_rescale_q(parts_[clock.part].step, AV_TIME_BASE_Q, stream.time_base);
  if (!is_time(step)) return;
  if (is_time(packet.dts)) packet.dts += step;
  if (is_time(packet.pts)) packet.pts += step;
}

}  // namespace knotreel::video
