// SPDX-License-Identifier: GPL-3.0-or-later
#include "libav.h"

#include <array>
#include <cctype>
#include <cstdio>
#include <limits>
#include <utility>

#include "knotreel/video/packet.h"

namespace knotreel::video {

std::string Options::value(const std::string& key) const {
  const AVDictionaryEntry* entry = find(key);
  return entry == nullptr ? std::string() : entry->value;
}

std::string Options::unused() const {
  const AVDictionaryEntry* entry = av_dict_get(dictionary_, "", nullptr, AV_DICT_IGNORE_SUFFIX);
  return entry == nullptr ? std::string() : entry->key;
}

namespace {

thread_local LogListener* listener = nullptr;  ///< the innermost one

void count_complaint(void* context) {
  if (context == nullptr) return;
  if (*static_cast<const AVClass* const*>(context) != avcodec_get_class()) return;
  void* complaints = static_cast<const AVCodecContext*>(context)->opaque;
  if (complaints != nullptr) ++*static_cast<Complaints*>(complaints);
}

void hear(void* context, int level, const char* format, va_list arguments) {
  if (level <= AV_LOG_ERROR) count_complaint(context);
  if (listener != nullptr) listener->hear(level, format, arguments);
}

}  // namespace

LogListener::LogListener() : before_(std::exchange(listener, this)) {}
LogListener::~LogListener() {
  listener = before_;
}

void LogListener::hear(int level, const char* format, va_list arguments) {
  if (level > AV_LOG_WARNING) return;
  std::string& first = level <= AV_LOG_ERROR ? first_error_ : first_warning_;
  if (!first.empty()) return;
  std::array<char, 400> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  first = text.data();
  while (!first.empty() && std::isspace(static_cast<unsigned char>(first.back())) != 0) first.pop_back();
}

void silence_libav() {
  static const bool once = [] {
    av_log_set_level(AV_LOG_QUIET);
    av_log_set_callback(hear);
    return true;
  }();
  (void)once;
}

std::string error_text(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof text);
  return text;
}

AVRational to_av(const Rational& value) {
  AVRational result{0, 1};
  av_reduce(&result.num, &result.den, value.num, value.den, std::numeric_limits<int>::max());
  return result;
}

Rational from_av(AVRational value) {
  if (value.num <= 0 || value.den <= 0) return {};
  return {value.num, value.den};
}

int Packet::stream() const {
  const auto* copied = static_cast<const CopiedPacket*>(impl());
  return copied == nullptr ? -1 : copied->packet->stream_index;
}

std::span<const std::byte> Packet::bytes() const {
  const auto* copied = static_cast<const CopiedPacket*>(impl());
  if (copied == nullptr) return {};
  return std::as_bytes(std::span(copied->packet->data, std::size_t(copied->packet->size)));
}

double Packet::seconds() const {
  const auto* copied = static_cast<const CopiedPacket*>(impl());
  if (copied == nullptr || copied->packet->pts == AV_NOPTS_VALUE) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return double(copied->packet->pts) * av_q2d(copied->time_base);
}

PacketPtr moved_packet(const CopiedPacket& packet, std::int64_t earlier, AVRational unit) {
  PacketPtr moved = new_packet();
  if (av_packet_ref(moved.get(), packet.packet.get()) < 0) throw std::bad_alloc();
  const std::int64_t away = av_rescale_q(earlier, unit, packet.time_base);
  if (moved->pts != AV_NOPTS_VALUE) moved->pts = av_sat_sub64(moved->pts, away);
  if (moved->dts != AV_NOPTS_VALUE) moved->dts = av_sat_sub64(moved->dts, away);
  return moved;
}

Packet Packet::earlier(std::int64_t ticks, Rational time_base) const {
  const auto* copied = static_cast<const CopiedPacket*>(impl());
  if (copied == nullptr || ticks == 0) return *this;
  return Packet(std::make_shared<const CopiedPacket>(
      CopiedPacket{moved_packet(*copied, ticks, to_av(time_base)), copied->time_base}));
}

}  // namespace knotreel::video
