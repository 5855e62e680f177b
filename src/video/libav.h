// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/avutil.h>
#include <libavutil/cpu.h>
#include <libavutil/display.h>
#include <libavutil/frame.h>
#include <libavutil/parseutils.h>
#include <libavutil/pixdesc.h>
}

#include <atomic>
#include <cstdarg>
#include <cstdint>
#include <memory>
#include <string>

#include "knotreel/base/ticks.h"
#include "knotreel/video/stream_info.h"

/// libav's objects as owners, and small translations.
namespace knotreel::video {

struct LibavDeleter {
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
};
using FramePtr = std::unique_ptr<AVFrame, LibavDeleter>;
using PacketPtr = std::unique_ptr<AVPacket, LibavDeleter>;
using CodecPtr = std::unique_ptr<AVCodecContext, LibavDeleter>;

/// An allocation of libav that must not be null. @throws std::bad_alloc
template <typename T>
T* allocated(T* pointer) {
  if (pointer == nullptr) throw std::bad_alloc();
  return pointer;
}

inline FramePtr new_frame() {
  return FramePtr(allocated(av_frame_alloc()));
}
inline PacketPtr new_packet() {
  return PacketPtr(allocated(av_packet_alloc()));
}

/// A dictionary of options.
class Options {
 public:
  Options() = default;
  ~Options() { av_dict_free(&dictionary_); }
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;

  void set(const std::string& key, const std::string& value) {
    av_dict_set(&dictionary_, key.c_str(), value.c_str(), 0);
  }
  /// For libav, which takes out what it has used.
  AVDictionary** get() { return &dictionary_; }
  bool contains(const std::string& key) const { return find(key) != nullptr; }
  /// What is set; empty if nothing is.
  std::string value(const std::string& key) const;
  /// Name of an option that nobody has used; empty if there is none.
  std::string unused() const;

 private:
  const AVDictionaryEntry* find(const std::string& key) const {
    return av_dict_get(dictionary_, key.c_str(), nullptr, AV_DICT_MATCH_CASE);
  }

  AVDictionary* dictionary_ = nullptr;
};

/// Stops libav from printing; of effect for the process, from the first call on.
void silence_libav();

/// How many errors a codec has told of in libav's log, if its `opaque` points here. From any thread.
using Complaints = std::atomic<std::uint64_t>;

/// Keeps the first error and the first warning that libav tells of in its log, in this thread, while it
/// lives.
class LogListener {
 public:
  LogListener();
  ~LogListener();
  LogListener(const LogListener&) = delete;
  LogListener& operator=(const LogListener&) = delete;

  /// Empty if there was none.
  const std::string& first_error() const { return first_error_; }
  const std::string& first_warning() const { return first_warning_; }

  /// A message of libav's; those that tell of no fault are passed over.
  void hear(int level, const char* format, va_list arguments);

 private:
  std::string first_error_, first_warning_;
  LogListener* before_;
};

/// What a negative result of libav means, in words.
std::string error_text(int code);

AVRational to_av(const Rational& value);
/// Unknown and meaningless values become 0/1.
Rational from_av(AVRational value);

/// A packet of a copied stream, with the time base that its times are in.
struct CopiedPacket {
  PacketPtr packet;
  AVRational time_base;
};

/// The same bytes, earlier by so many units; times stay in the time base of the packet.
PacketPtr moved_packet(const CopiedPacket& packet, std::int64_t earlier, AVRational unit);

}  // namespace knotreel::video
