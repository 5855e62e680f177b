// SPDX-License-Identifier: GPL-3.0-or-later
#include "copied_streams.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace knotreel::video {
namespace {

struct ContextDeleter {
  void operator()(AVFormatContext* p) const {
    if (p->pb != nullptr) {
      std::uint8_t* bytes = nullptr;
      avio_close_dyn_buf(p->pb, &bytes);
      av_free(bytes);
    }
    avformat_free_context(p);
  }
};

/// The four letters of another container would be wrong in this one, unless it knows them too.
void fit_tag(AVCodecParameters& parameters, const AVOutputFormat& container) {
  const unsigned tag = parameters.codec_tag;
  parameters.codec_tag = 0;
  if (container.codec_tag == nullptr) return;
  unsigned known = 0;
  const bool any = av_codec_get_tag2(container.codec_tag, parameters.codec_id, &known) != 0;
  if (!any || av_codec_get_id(container.codec_tag, tag) == parameters.codec_id) parameters.codec_tag = tag;
}

void copy_side_data(const AVStream& from, AVStream& to, bool (*wanted)(AVPacketSideDataType)) {
  for (int i = 0; i < from.nb_side_data; ++i) {
    const AVPacketSideData& data = from.side_data[i];
    if (!wanted(data.type)) continue;
    std::uint8_t* bytes = av_stream_new_side_data(&to, data.type, data.size);
    if (bytes != nullptr) std::memcpy(bytes, data.data, data.size);
  }
}

void copy_stream(const AVStream& from, AVFormatContext& output) {
  AVStream* stream = allocated(avformat_new_stream(&output, nullptr));
  if (avcodec_parameters_copy(stream->codecpar, from.codecpar) < 0) throw std::bad_alloc();
  fit_tag(*stream->codecpar, *output.oformat);
  stream->time_base = from.time_base;
  stream->avg_frame_rate = from.avg_frame_rate;
  stream->disposition = from.disposition;
  av_dict_copy(&stream->metadata, from.metadata, 0);
  copy_side_data(from, *stream, [](AVPacketSideDataType) { return true; });
}

/// What transport streams have a type for; anything else becomes private data, which nobody can read.
bool is_for_transport(AVCodecID id) {
  constexpr std::array kCodecs{AV_CODEC_ID_MP1,          AV_CODEC_ID_MP2,
                               AV_CODEC_ID_MP3,          AV_CODEC_ID_AAC,
                               AV_CODEC_ID_AAC_LATM,     AV_CODEC_ID_AC3,
                               AV_CODEC_ID_EAC3,         AV_CODEC_ID_DTS,
                               AV_CODEC_ID_TRUEHD,       AV_CODEC_ID_S302M,
                               AV_CODEC_ID_OPUS,         AV_CODEC_ID_DVB_SUBTITLE,
                               AV_CODEC_ID_DVB_TELETEXT, AV_CODEC_ID_HDMV_PGS_SUBTITLE,
                               AV_CODEC_ID_SMPTE_KLV,    AV_CODEC_ID_TIMED_ID3};
  return std::find(kCodecs.begin(), kCodecs.end(), id) != kCodecs.end();
}

/// Muxers of program streams take any text for the pictures of DVDs.
bool is_program_stream(const std::string& container) {
  constexpr std::array kNames{"mpeg", "vob", "dvd", "svcd", "vcd"};
  return std::find(kNames.begin(), kNames.end(), container) != kNames.end();
}

/// False where it is certain.
bool may_take(const AVOutputFormat& container, const AVCodecParameters& candidate) {
  const AVCodecID id = candidate.codec_id;
  const std::string name = container.name;
  if (id == AV_CODEC_ID_NONE) return false;
  // Asked for fonts, it says no, and takes them.
  if (candidate.codec_type == AVMEDIA_TYPE_ATTACHMENT) return name == "matroska";
  if (name == "mpegts") return is_for_transport(id);
  if (is_program_stream(name) && candidate.codec_type == AVMEDIA_TYPE_SUBTITLE)
    return id == AV_CODEC_ID_DVD_SUBTITLE;
  // By its rate of bytes, which these do not have, AVI would tell wrong times.
  if (name == "avi" && (id == AV_CODEC_ID_FLAC || id == AV_CODEC_ID_VORBIS)) return false;
  // Sound that Matroska has no name for goes by its number in WAV files; if it has none, the header fails.
  // That of Flash nobody reads.
  const bool has_numbers =
      name == "matroska" && candidate.codec_type == AVMEDIA_TYPE_AUDIO && id != AV_CODEC_ID_ADPCM_SWF;
  const int answer =
      avformat_query_codec(&container, id, has_numbers ? FF_COMPLIANCE_UNOFFICIAL : FF_COMPLIANCE_NORMAL);
  // One that does not know and has no sound of its own, such as rawvideo, is a row of pictures, in which any
  // other packet would be taken for one.
  return answer > 0 || (answer < 0 && container.audio_codec != AV_CODEC_ID_NONE);
}

/// Muxers tell what they cannot hold, or not beside what is there already, when the header is written; so one
/// is written, into memory.
bool takes(const AVFormatContext& output, const AVStream& candidate) {
  if (!may_take(*output.oformat, *candidate.codecpar)) return false;
  AVFormatContext* made = nullptr;
  if (avformat_alloc_output_context2(&made, output.oformat, nullptr, nullptr) < 0) throw std::bad_alloc();
  const std::unique_ptr<AVFormatContext, ContextDeleter> trial(made);
  trial->strict_std_compliance = output.strict_std_compliance;
  AVStream* video = allocated(avformat_new_stream(trial.get(), nullptr));
  if (avcodec_parameters_copy(video->codecpar, output.streams[0]->codecpar) < 0) throw std::bad_alloc();
  video->time_base = output.streams[0]->time_base;
  for (unsigned i = 1; i < output.nb_streams; ++i) copy_stream(*output.streams[i], *trial);
  copy_stream(candidate, *trial);
  return avio_open_dyn_buf(&trial->pb) >= 0 && avformat_write_header(trial.get(), nullptr) >= 0;
}

std::string left_out(const AVStream& stream, const AVFormatContext& output) {
  const char* type = av_get_media_type_string(stream.codecpar->codec_type);
  return "stream " + std::to_string(stream.index) + " (" + (type == nullptr ? "data" : type) + ", " +
         avcodec_get_name(stream.codecpar->codec_id) + ") is left out: container '" + output.oformat->name +
         "' does not take it";
}

void copy_chapters(const AVFormatContext& from, AVFormatContext& to) {
  for (unsigned i = 0; i < from.nb_chapters; ++i) {
    const AVChapter& chapter = *from.chapters[i];
    auto* copy = static_cast<AVChapter*>(allocated(av_mallocz(sizeof(AVChapter))));
    *copy = AVChapter{chapter.id, chapter.time_base, chapter.start, chapter.end, nullptr};
    av_dict_copy(&copy->metadata, chapter.metadata, 0);
    if (av_dynarray_add_nofree(&to.chapters, reinterpret_cast<int*>(&to.nb_chapters), copy) < 0) {
      throw std::bad_alloc();
    }
  }
}

bool is_statistic(std::string_view key) {
  static constexpr std::array kBeginnings = {"_STATISTICS_", "BPS-", "DURATION-", "NUMBER_OF_FRAMES-",
                                             "NUMBER_OF_BYTES-"};
  return std::any_of(kBeginnings.begin(), kBeginnings.end(),
                     [&](const char* beginning) { return key.starts_with(beginning); });
}

/// What the source's container said of itself is not true of the output.
void drop_stale(AVDictionary** metadata) {
  for (const char* key : {"encoder", "major_brand", "minor_version", "compatible_brands", "creation_time",
                          "rotate", "alpha_mode", "duration", "NUMBER_OF_FRAMES", "NUMBER_OF_BYTES", "BPS"}) {
    av_dict_set(metadata, key, nullptr, 0);
  }
  // mkvmerge's, with a language at their ends.
  std::vector<std::string> statistics;
  const AVDictionaryEntry* entry = nullptr;
  while ((entry = av_dict_get(*metadata, "", entry, AV_DICT_IGNORE_SUFFIX)) != nullptr) {
    if (is_statistic(entry->key)) statistics.emplace_back(entry->key);
  }
  for (const std::string& key : statistics) av_dict_set(metadata, key.c_str(), nullptr, 0);
}

/// In mp4 a text of no letters stands where none is shown; its muxer puts these there, beside any copied
/// ones.
bool is_pause(const AVPacket& packet, const AVStream& stream) {
  return stream.codecpar->codec_id == AV_CODEC_ID_MOV_TEXT && packet.size == 2;
}

/// What has to be added to the times of a stream, in ticks of it, for readers to find these. Matroska has
/// those of Opus with the samples that decoders leave out at the start; libav takes them off when it reads,
/// but does not add them when it writes.
std::int64_t delay_of_container(const AVStream& stream, const AVOutputFormat& container) {
  const std::string_view name = container.name;
  const bool is_matroska = name == "matroska" || name == "webm";
  if (!is_matroska || stream.codecpar->codec_id != AV_CODEC_ID_OPUS) return 0;
  return av_rescale_q(stream.codecpar->initial_padding, {1, 48000}, stream.time_base);
}

}  // namespace

void CopiedStreams::make(const Source& source, AVFormatContext& output, Warnings& warnings) {
  const AVFormatContext* input = source.format();
  if (input == nullptr) return;
  for (const int i : source.copied_streams()) {
    const AVStream& stream = *input->streams[i];
    if (!takes(output, stream)) {
      warnings.add(left_out(stream, output));
      continue;
    }
    targets_[i] = {int(output.nb_streams), AV_NOPTS_VALUE};
    copy_stream(stream, output);
    drop_stale(&output.streams[output.nb_streams - 1]->metadata);
  }
  av_dict_copy(&output.metadata, input->metadata, 0);
  drop_stale(&output.metadata);
  if (source.copies_chapters()) copy_chapters(*input, output);
}

PacketPtr CopiedStreams::prepare(const Packet& packet, std::int64_t start, AVRational unit,
                                 const AVFormatContext& output) {
  const auto* copied = static_cast<const CopiedPacket*>(packet.impl());
  if (copied == nullptr) return {};
  const auto found = targets_.find(copied->packet->stream_index);
  if (found == targets_.end()) return {};
  if (is_pause(*copied->packet, *output.streams[found->second.stream])) return {};
  PacketPtr result = moved_packet(*copied, start, unit);
  Target& target = found->second;
  if (result->dts == AV_NOPTS_VALUE) result->dts = result->pts;
  const AVStream& stream = *output.streams[target.stream];
  av_packet_rescale_ts(result.get(), copied->time_base, stream.time_base);
  const std::int64_t delay = delay_of_container(stream, *output.oformat);
  if (result->dts != AV_NOPTS_VALUE) result->dts += delay;
  if (result->pts != AV_NOPTS_VALUE) result->pts += delay;
  // Muxers refuse times that do not go up; damaged sources have them.
  if (target.last_dts != AV_NOPTS_VALUE && result->dts != AV_NOPTS_VALUE) {
    const bool equal_is_fine = (output.oformat->flags & AVFMT_TS_NONSTRICT) != 0;
    const std::int64_t least = target.last_dts + (equal_is_fine ? 0 : 1);
    if (result->dts < least) result->dts = least;
    if (result->pts != AV_NOPTS_VALUE) result->pts = std::max(result->pts, result->dts);
  }
  if (result->dts != AV_NOPTS_VALUE) target.last_dts = result->dts;
  result->stream_index = target.stream;
  result->pos = -1;
  return result;
}

void copy_video_properties(const Source& source, AVStream& video) {
  const AVFormatContext* input = source.format();
  if (input == nullptr) return;
  const AVStream& from = *input->streams[source.video_stream()];
  av_dict_copy(&video.metadata, from.metadata, 0);
  drop_stale(&video.metadata);
  video.disposition = from.disposition;
  copy_side_data(from, video, [](AVPacketSideDataType type) {
    return type == AV_PKT_DATA_MASTERING_DISPLAY_METADATA || type == AV_PKT_DATA_CONTENT_LIGHT_LEVEL ||
           type == AV_PKT_DATA_STEREO3D || type == AV_PKT_DATA_SPHERICAL;
  });
}

}  // namespace knotreel::video
