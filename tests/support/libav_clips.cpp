// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/libav_clips.h"

extern "C" {
#include <libavutil/opt.h>
}

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "video/libav.h"

namespace knotreel::video {
namespace {

int checked(int result) {
  if (result < 0) throw std::runtime_error(error_text(result));
  return result;
}

/// One stream of the clip.
struct Track {
  CodecPtr encoder;
  AVStream* stream = nullptr;
};

Track add_track(AVFormatContext& output, const AVCodec* codec) {
  Track track;
  track.encoder.reset(allocated(avcodec_alloc_context3(allocated(codec))));
  track.stream = allocated(avformat_new_stream(&output, nullptr));
  if ((output.oformat->flags & AVFMT_GLOBALHEADER) != 0) track.encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  return track;
}

void open(Track& track) {
  checked(avcodec_open2(track.encoder.get(), nullptr, nullptr));
  checked(avcodec_parameters_from_context(track.stream->codecpar, track.encoder.get()));
  track.stream->time_base = track.encoder->time_base;
}

Track add_sound(AVFormatContext& output, const std::string& codec) {
  Track track = add_track(output, avcodec_find_encoder_by_name(codec.c_str()));
  AVCodecContext& encoder = *track.encoder;
  // Opus takes no other rate.
  encoder.sample_rate = codec == "libopus" ? 48000 : 44100;
  encoder.sample_fmt = encoder.codec->sample_fmts[0];
  encoder.time_base = {1, encoder.sample_rate};
  av_channel_layout_default(&encoder.ch_layout, 1);
  open(track);
  return track;
}

void set_picture(AVCodecContext& encoder, int width, int height) {
  encoder.width = width;
  encoder.height = height;
  encoder.pix_fmt = AV_PIX_FMT_YUV420P;
  encoder.time_base = {1, 25};
  encoder.framerate = {25, 1};
}

Track add_video(AVFormatContext& output) {
  Track track = add_track(output, avcodec_find_encoder(AV_CODEC_ID_MPEG4));
  AVCodecContext& encoder = *track.encoder;
  set_picture(encoder, 64, 48);
  open(track);
  return track;
}

void send(AVFormatContext& output, Track& track, AVFrame* frame) {
  checked(avcodec_send_frame(track.encoder.get(), frame));
  const PacketPtr packet = new_packet();
  while (avcodec_receive_packet(track.encoder.get(), packet.get()) >= 0) {
    packet->stream_index = track.stream->index;
    if (packet->duration == 0) packet->duration = 1;
    av_packet_rescale_ts(packet.get(), track.encoder->time_base, track.stream->time_base);
    checked(av_interleaved_write_frame(&output, packet.get()));
  }
}

void fill(AVFrame& frame) {
  for (int i = 0; i < frame.nb_samples; ++i) {
    const double value = 0.3 * std::sin(0.06 * double(frame.pts + i));
    if (frame.format == AV_SAMPLE_FMT_FLTP) {
      reinterpret_cast<float*>(frame.data[0])[i] = float(value);
    } else {
      reinterpret_cast<std::int16_t*>(frame.data[0])[i] = std::int16_t(value * 32767);
    }
  }
}

void send_sound(AVFormatContext& output, Track& track, int seconds) {
  const int size = track.encoder->frame_size > 0 ? track.encoder->frame_size : 1024;
  const int rate = track.encoder->sample_rate;
  for (int at = 0; at + size <= rate * seconds; at += size) {
    const FramePtr frame = new_frame();
    frame->format = track.encoder->sample_fmt;
    frame->nb_samples = size;
    frame->pts = at;
    frame->sample_rate = rate;
    av_channel_layout_default(&frame->ch_layout, 1);
    checked(av_frame_get_buffer(frame.get(), 0));
    fill(*frame);
    send(output, track, frame.get());
  }
  send(output, track, nullptr);
}

void send_video(AVFormatContext& output, Track& track, int seconds) {
  for (int i = 0; i < 25 * seconds; ++i) {
    const FramePtr frame = new_frame();
    frame->format = AV_PIX_FMT_YUV420P;
    frame->width = 64;
    frame->height = 48;
    frame->pts = i;
    checked(av_frame_get_buffer(frame.get(), 0));
    for (const AVBufferRef* buffer : frame->buf) {
      if (buffer != nullptr) std::memset(buffer->data, 100 + i % 100, buffer->size);
    }
    send(output, track, frame.get());
  }
  send(output, track, nullptr);
}

Track add_open_gop_video(AVFormatContext& output) {
  Track track = add_track(output, avcodec_find_encoder_by_name("libx264"));
  AVCodecContext& encoder = *track.encoder;
  set_picture(encoder, 128, 96);
  checked(av_opt_set(encoder.priv_data, "x264-params",
                     "open-gop=1:keyint=25:min-keyint=25:bframes=3:b-adapt=0:scenecut=0", 0));
  open(track);
  return track;
}

void fill_with_waves(AVFrame& frame) {
  for (int plane = 0; plane < 3; ++plane) {
    const int shift = plane == 0 ? 0 : 1;
    for (int y = 0; y < frame.height >> shift; ++y) {
      for (int x = 0; x < frame.width >> shift; ++x) {
        const double wave =
            std::sin(0.11 * (x + 3 * double(frame.pts))) * std::cos(0.13 * (y - double(frame.pts)));
        frame.data[plane][y * frame.linesize[plane] + x] = std::uint8_t(128 + 60 * wave);
      }
    }
  }
}

void send_waves(AVFormatContext& output, Track& track, int seconds) {
  for (int i = 0; i < 25 * seconds; ++i) {
    const FramePtr frame = new_frame();
    frame->format = track.encoder->pix_fmt;
    frame->width = track.encoder->width;
    frame->height = track.encoder->height;
    frame->pts = i;
    checked(av_frame_get_buffer(frame.get(), 0));
    fill_with_waves(*frame);
    send(output, track, frame.get());
  }
  send(output, track, nullptr);
}

int add_texts(AVFormatContext& output, AVCodecID codec) {
  AVStream* stream = allocated(avformat_new_stream(&output, nullptr));
  stream->codecpar->codec_type = AVMEDIA_TYPE_SUBTITLE;
  stream->codecpar->codec_id = codec;
  stream->time_base = {1, 1000};
  av_dict_set(&stream->metadata, "language", "ger", 0);
  // As mkvmerge tells them.
  av_dict_set(&stream->metadata, "BPS-ger", "12345", 0);
  av_dict_set(&stream->metadata, "_STATISTICS_TAGS-ger", "BPS", 0);
  return stream->index;
}

void add_font(AVFormatContext& output) {
  AVStream* stream = allocated(avformat_new_stream(&output, nullptr));
  AVCodecParameters& parameters = *stream->codecpar;
  parameters.codec_type = AVMEDIA_TYPE_ATTACHMENT;
  parameters.codec_id = AV_CODEC_ID_TTF;
  parameters.extradata_size = 1000;
  parameters.extradata =
      static_cast<std::uint8_t*>(allocated(av_mallocz(1000 + AV_INPUT_BUFFER_PADDING_SIZE)));
  av_dict_set(&stream->metadata, "filename", "plain.ttf", 0);
  av_dict_set(&stream->metadata, "mimetype", "application/x-truetype-font", 0);
}

void send_texts(AVFormatContext& output, int index) {
  for (int i = 0; i < 3; ++i) {
    std::string text = "Zeile " + std::to_string(i);
    // Texts of mp4 begin with their length.
    if (output.streams[index]->codecpar->codec_id == AV_CODEC_ID_MOV_TEXT)
      text = std::string{0, char(text.size())} + text;
    const PacketPtr packet = new_packet();
    checked(av_new_packet(packet.get(), int(text.size())));
    std::memcpy(packet->data, text.data(), text.size());
    packet->stream_index = index;
    packet->pts = packet->dts = 100 + 300 * i;
    packet->duration = 200;
    checked(av_interleaved_write_frame(&output, packet.get()));
  }
}

AVFormatContext* new_clip(const std::string& path) {
  silence_libav();
  AVFormatContext* output = nullptr;
  checked(avformat_alloc_output_context2(&output, nullptr, nullptr, path.c_str()));
  return output;
}

void begin(AVFormatContext& output, const std::string& path) {
  checked(avio_open(&output.pb, path.c_str(), AVIO_FLAG_WRITE));
  checked(avformat_write_header(&output, nullptr));
}

void end(AVFormatContext* output) {
  checked(av_write_trailer(output));
  avio_closep(&output->pb);
  avformat_free_context(output);
}

}  // namespace

void write_sound_clip(const std::string& path, const std::string& codec, bool video, int seconds) {
  AVFormatContext* output = new_clip(path);
  Track sound = add_sound(*output, codec);
  Track picture;
  if (video) picture = add_video(*output);
  begin(*output, path);
  send_sound(*output, sound, seconds);
  if (video) send_video(*output, picture, seconds);
  end(output);
}

void write_clip_with_two_sounds(const std::string& path) {
  AVFormatContext* output = new_clip(path);
  Track picture = add_video(*output);
  Track first = add_sound(*output, "aac"), second = add_sound(*output, "aac");
  begin(*output, path);
  send_sound(*output, first, 1);
  send_sound(*output, second, 1);
  send_video(*output, picture, 1);
  end(output);
}

void write_open_gop_clip(const std::string& path, int seconds) {
  AVFormatContext* output = new_clip(path);
  Track picture = add_open_gop_video(*output);
  begin(*output, path);
  send_waves(*output, picture, seconds);
  end(output);
}

void write_clip_with_mp4_texts(const std::string& path) {
  AVFormatContext* output = new_clip(path);
  Track picture = add_video(*output);
  const int texts = add_texts(*output, AV_CODEC_ID_MOV_TEXT);
  begin(*output, path);
  send_texts(*output, texts);
  send_video(*output, picture, 1);
  end(output);
}

void write_titled_clip(const std::string& path) {
  AVFormatContext* output = new_clip(path);
  Track picture = add_video(*output);
  Track sound = add_sound(*output, "aac");
  const int texts = add_texts(*output, AV_CODEC_ID_SUBRIP);
  add_font(*output);
  begin(*output, path);
  send_sound(*output, sound, 1);
  send_texts(*output, texts);
  send_video(*output, picture, 1);
  end(output);
}

}  // namespace knotreel::video
