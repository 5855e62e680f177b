// SPDX-License-Identifier: GPL-3.0-or-later
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/channel_layout.h>
}

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "clip.h"

namespace knotreel::media {
namespace {

struct Deleter {
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
  void operator()(AVFormatContext* p) const {
    if (p->oformat != nullptr) {
      avio_closep(&p->pb);
      avformat_free_context(p);
    } else {
      avformat_close_input(&p);
    }
  }
};
template <class T>
using Owned = std::unique_ptr<T, Deleter>;

void check(int result, const char* what) {
  if (result < 0) throw std::runtime_error(std::string("cannot ") + what);
}

Owned<AVFormatContext> open_video(const std::string& path) {
  AVFormatContext* input = nullptr;
  check(avformat_open_input(&input, path.c_str(), nullptr, nullptr), "open the video");
  Owned<AVFormatContext> owned(input);
  check(avformat_find_stream_info(input, nullptr), "read the video");
  return owned;
}

Owned<AVFormatContext> make_output(const std::string& path) {
  AVFormatContext* output = nullptr;
  check(avformat_alloc_output_context2(&output, nullptr, nullptr, path.c_str()), "choose a container");
  Owned<AVFormatContext> owned(output);
  output->flags |= AVFMT_FLAG_BITEXACT;
  check(avio_open(&output->pb, path.c_str(), AVIO_FLAG_WRITE), "create the output");
  return owned;
}

Owned<AVCodecContext> open_encoder() {
  const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_AAC);
  if (codec == nullptr) throw std::runtime_error("there is no AAC encoder");
  Owned<AVCodecContext> encoder(avcodec_alloc_context3(codec));
  encoder->sample_rate = kSoundRate;
  encoder->sample_fmt = AV_SAMPLE_FMT_FLTP;
  encoder->ch_layout = AV_CHANNEL_LAYOUT_MONO;
  encoder->bit_rate = 64000;
  encoder->time_base = {1, kSoundRate};
  encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_BITEXACT;
  check(avcodec_open2(encoder.get(), codec, nullptr), "open the encoder");
  return encoder;
}

void copy_video(AVFormatContext& input, AVFormatContext& output) {
  const Owned<AVPacket> packet(av_packet_alloc());
  while (av_read_frame(&input, packet.get()) >= 0) {
    av_packet_rescale_ts(packet.get(), input.streams[0]->time_base, output.streams[0]->time_base);
    packet->pos = -1;
    check(av_interleaved_write_frame(&output, packet.get()), "write the video");
  }
}

/// @param frame  null: the end
void encode(AVCodecContext& encoder, const AVFrame* frame, AVFormatContext& output) {
  check(avcodec_send_frame(&encoder, frame), "encode the sound");
  const Owned<AVPacket> packet(av_packet_alloc());
  while (avcodec_receive_packet(&encoder, packet.get()) >= 0) {
    packet->stream_index = 1;
    av_packet_rescale_ts(packet.get(), encoder.time_base, output.streams[1]->time_base);
    check(av_interleaved_write_frame(&output, packet.get()), "write the sound");
  }
}

void write_sound(AVCodecContext& encoder, const std::vector<float>& sound, AVFormatContext& output) {
  for (std::size_t from = 0; from < sound.size(); from += std::size_t(encoder.frame_size)) {
    const Owned<AVFrame> frame(av_frame_alloc());
    frame->nb_samples = int(std::min(std::size_t(encoder.frame_size), sound.size() - from));
    frame->format = encoder.sample_fmt;
    frame->ch_layout = encoder.ch_layout;
    frame->sample_rate = encoder.sample_rate;
    frame->pts = std::int64_t(from);
    check(av_frame_get_buffer(frame.get(), 0), "hold the sound");
    std::copy_n(sound.data() + from, frame->nb_samples, reinterpret_cast<float*>(frame->data[0]));
    encode(encoder, frame.get(), output);
  }
  encode(encoder, nullptr, output);
}

}  // namespace

void add_sound(const std::string& video, const std::vector<float>& sound, const std::string& output_path) {
  const Owned<AVFormatContext> input = open_video(video);
  const Owned<AVFormatContext> output = make_output(output_path);
  const Owned<AVCodecContext> encoder = open_encoder();
  AVStream* pictures = avformat_new_stream(output.get(), nullptr);
  check(avcodec_parameters_copy(pictures->codecpar, input->streams[0]->codecpar), "copy the video");
  pictures->time_base = input->streams[0]->time_base;
  pictures->avg_frame_rate = {kClipRate, 1};
  AVStream* tune = avformat_new_stream(output.get(), nullptr);
  check(avcodec_parameters_from_context(tune->codecpar, encoder.get()), "describe the sound");
  tune->time_base = encoder->time_base;
  check(avformat_write_header(output.get(), nullptr), "write the header");
  copy_video(*input, *output);
  write_sound(*encoder, sound, *output);
  check(av_write_trailer(output.get()), "finish the output");
}

}  // namespace knotreel::media
