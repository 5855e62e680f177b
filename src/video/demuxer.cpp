// SPDX-License-Identifier: GPL-3.0-or-later
#include "demuxer.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"

namespace knotreel::video {
namespace {

/// A file name with a colon must not be taken for a URL.
std::string url_of(const std::string& input) {
  if (input == "-") return "pipe:0";
  if (input.find("://") != std::string::npos) return input;
  return "file:" + input;
}

bool is_pipe(const std::string& input) {
  std::error_code ignored;
  return input == "-" || std::filesystem::is_fifo(input, ignored);
}

void check_file(const std::string& input, const std::string& cannot_read) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(input, ignored)) return;
  if (std::filesystem::file_size(input, ignored) == 0) {
    throw Error(ErrorKind::kInput, cannot_read + "the file is empty");
  }
}

const AVInputFormat* forced_format(const std::string& name) {
  if (name.empty()) return nullptr;
  const AVInputFormat* format = av_find_input_format(name.c_str());
  if (format == nullptr) throw Error(ErrorKind::kInvalidArgument, "no input format is called '" + name + "'");
  return format;
}

std::string why_not(int code) {
  if (code == AVERROR_INVALIDDATA) return "not a video in a known format, or cut short";
  if (code == AVERROR_EOF) return "the file is cut short";
  if (code == AVERROR(EINVAL)) return "this format has to be told more, such as its video_size";
  return error_text(code);
}

/// Text files pass for "ANSI art" by their name.
bool is_text(const AVInputFormat& format) {
  return std::strcmp(format.name, "tty") == 0;
}

bool has_picture(const AVStream& stream) {
  return stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO &&
         (stream.disposition & AV_DISPOSITION_ATTACHED_PIC) == 0;
}

}  // namespace

bool reads_pictures(const AVInputFormat& format) {
  const std::string name = format.name;
  return name == "image2" || name.ends_with("_pipe");
}

Demuxer::Demuxer(const std::string& input, const ReadOptions& options)
    : input_(input), cannot_read_(knotreel::cannot_read(input, "video")), copy_(options.copy_streams) {
  check_file(input, cannot_read_);
  open(input, options);
  const int found = avformat_find_stream_info(format_.get(), nullptr);
  if (found < 0) throw Error(ErrorKind::kInput, cannot_read_ + why_not(found));
  choose_video();
  discard_others();
}

void Demuxer::open(const std::string& input, const ReadOptions& options) {
  Options dictionary;
  for (const auto& [key, value] : options.demuxer_options) dictionary.set(key, value);
  const AVInputFormat* forced = forced_format(options.format);
  if (is_pipe(input)) pipe_ = std::make_unique<PipeIo>(url_of(input), cannot_read_);
  AVFormatContext* opened = allocated(avformat_alloc_context());
  if (pipe_) opened->pb = pipe_->context();
  const int result = avformat_open_input(&opened, url_of(input).c_str(), forced, dictionary.get());
  if (result < 0) throw Error(ErrorKind::kInput, cannot_read_ + why_not(result));
  format_.reset(opened);
  if (forced == nullptr && is_text(*opened->iformat)) {
    throw Error(ErrorKind::kInput, cannot_read_ + why_not(AVERROR_INVALIDDATA));
  }
  if (const std::string unused = dictionary.unused(); !unused.empty()) {
    throw Error(ErrorKind::kInvalidArgument,
                "input format '" + std::string(opened->iformat->name) + "' has no option '" + unused + "'");
  }
}

void Demuxer::choose_video() {
  const int best = av_find_best_stream(format_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (best >= 0 && has_picture(*format_->streams[best])) video_ = best;
  for (unsigned i = 0; i < format_->nb_streams && video_ < 0; ++i) {
    if (has_picture(*format_->streams[i])) video_ = int(i);
  }
  if (video_ < 0) {
    const std::string name = input_ == "-" ? "standard input" : "'" + input_ + "'";
    throw Error(ErrorKind::kInput, name + " has no video stream");
  }
}

void Demuxer::discard_others() {
  for (unsigned i = 0; i < format_->nb_streams; ++i) {
    if (int(i) != video_ && !copied(int(i))) format_->streams[i]->discard = AVDISCARD_ALL;
  }
}

std::unique_ptr<std::istream> Demuxer::from_its_start() const {
  if (pipe_) return pipe_->in_memory() ? std::make_unique<std::istringstream>(pipe_->text()) : nullptr;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(input_, ignored)) return nullptr;
  return std::make_unique<std::ifstream>(input_, std::ios::binary);
}

bool Demuxer::copied(int stream) const {
  if (!copy_ || stream == video_) return false;
  const AVStream& candidate = *format_->streams[stream];
  // What libav discards by itself are the texts of chapters, which are copied as chapters.
  if (candidate.discard == AVDISCARD_ALL) return false;
  const AVMediaType type = candidate.codecpar->codec_type;
  return type == AVMEDIA_TYPE_AUDIO || type == AVMEDIA_TYPE_SUBTITLE || type == AVMEDIA_TYPE_DATA ||
         type == AVMEDIA_TYPE_ATTACHMENT;
}

int Demuxer::other_videos() const {
  int count = 0;
  for (unsigned i = 0; i < format_->nb_streams; ++i) {
    if (int(i) != video_ && has_picture(*format_->streams[i])) ++count;
  }
  return count;
}

int Demuxer::covers() const {
  int count = 0;
  for (unsigned i = 0; i < format_->nb_streams; ++i)
    count += (format_->streams[i]->disposition & AV_DISPOSITION_ATTACHED_PIC) != 0 ? 1 : 0;
  return count;
}

/// YUV4MPEG has frames and nothing else, and libav drops a last one that is not whole.
bool Demuxer::ends_in_a_frame() const {
  return std::string_view(format_->iformat->name) == "yuv4mpegpipe" && packets_end_ > 0 &&
         avio_tell(format_->pb) > packets_end_;
}

/// Whether the last sample that the index of an MP4 lists has been read. That of a file in fragments grows
/// with what is read, and tells nothing.
bool Demuxer::has_read_index() const {
  const bool whole_index = std::string_view(format_->iformat->name).find("mp4") != std::string_view::npos &&
                           video()->nb_frames > 0;
  const int count = avformat_index_get_entries_count(video());
  if (!whole_index || count == 0 || video_dts_ == AV_NOPTS_VALUE) return false;
  return video_dts_ >= avformat_index_get_entry(video(), count - 1)->timestamp;
}

FileEnd Demuxer::end() const {
  if (has_read_index()) return FileEnd::kThere;
  const std::string format = format_->iformat->name;
  if (!pipe_) return end_of_file(input_, format);
  return end_of_pipe(pipe_->start(), std::uint64_t(avio_tell(pipe_->context())), format);
}

/// Of other formats, some know only when packets are decoded, and some have clocks that jump.
bool Demuxer::has_index() const {
  const std::string_view name = format_->iformat->name;
  const bool knows =
      name.find("mp4") != std::string_view::npos || name.find("matroska") != std::string_view::npos;
  return knows && format_->pb != nullptr && (format_->pb->seekable & AVIO_SEEKABLE_NORMAL) != 0;
}

bool Demuxer::numbers_packets() const {
  return std::string_view(format_->iformat->name) == "mpegts";
}

bool Demuxer::seek(std::int64_t pts) {
  return has_index() && av_seek_frame(format_.get(), video_, pts, AVSEEK_FLAG_BACKWARD) >= 0;
}

PacketPtr Demuxer::read(std::string& why) {
  PacketPtr packet = new_packet();
  for (;;) {
    const int result = av_read_frame(format_.get(), packet.get());
    if (result == AVERROR(EAGAIN)) continue;
    if (result < 0) {
      const bool broken =
          result != AVERROR_EOF || (format_->pb != nullptr && format_->pb->error < 0) || ends_in_a_frame();
      if (broken)
        why = result == AVERROR_INVALIDDATA || result == AVERROR_EOF ? "cut short or damaged"
                                                                     : error_text(result);
      return {};
    }
    if (packet->pos >= 0) packets_end_ = packet->pos + packet->size;
    if (packet->stream_index == video_) video_dts_ = packet->dts;
    // Streams may turn up late, when everything has been set up without them.
    if (packet->stream_index == video_ || copied(packet->stream_index)) {
      if ((format_->iformat->flags & AVFMT_TS_DISCONT) != 0)
        times_.move(*packet, *format_->streams[packet->stream_index]);
      return packet;
    }
    av_packet_unref(packet.get());
  }
}

}  // namespace knotreel::video
