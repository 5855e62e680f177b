// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/copied_packets.h"

#include <limits>

#include "knotreel/pipeline/sequence.h"

namespace knotreel::pipeline {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

}  // namespace

/// Sound may begin before the first frame of the source and go on after its last one: that is kept.
CopiedPackets::CopiedPackets(const RenderJob& job, const Schedule& schedule)
    : reader_(job.copied),
      origin_(schedule.origin()),
      document_tick_(stream_info(job.reader->info()).time_base),
      tick_(schedule.stream().time_base),
      begin_(job.first > 0 ? source_seconds(schedule.begin()) : -kForever),
      end_(kForever) {
  if (job.last && *job.last + 1 < job.reader->frame_count()) end_ = source_seconds(schedule.end());
}

double CopiedPackets::source_seconds(std::int64_t pts) const {
  return static_cast<double>(pts) * tick_.value() + static_cast<double>(origin_) * document_tick_.value();
}

std::vector<video::Packet> CopiedPackets::moved(std::vector<video::Packet> packets) const {
  std::erase_if(packets, [&](const video::Packet& packet) {
    return packet.seconds() < begin_ || packet.seconds() >= end_;
  });
  for (video::Packet& packet : packets) packet = packet.earlier(origin_, document_tick_);
  return packets;
}

std::vector<video::Packet> CopiedPackets::until_end_of(const Showing& frame) {
  if (reader_ == nullptr) return {};
  return moved(reader_->packets_until(source_seconds(frame.pts + frame.duration)));
}

std::vector<video::Packet> CopiedPackets::rest() {
  if (reader_ == nullptr) return {};
  return moved(reader_->packets_until(end_));
}

}  // namespace knotreel::pipeline
