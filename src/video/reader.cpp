// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/video/reader.h"

#include <cctype>
#include <filesystem>
#include <string_view>

#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/image/format.h"
#include "knotreel/video/picture_list.h"
#include "source.h"
#include "stream_description.h"

namespace knotreel::video {
namespace {

/// A stream of JPEG pictures, one behind the other, begins like a single one.
bool is_called_motion_jpeg(const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".mjpeg" || extension == ".mjpg";
}

bool is_picture_file(const std::string& input) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(input, ignored) &&
         holds_one_picture(read_start(input, kPictureStart), input);
}

std::unique_ptr<Source> open_source(const std::string& input, const ReadOptions& options) {
  if (means_pictures(input)) {
    const std::vector<std::string> pictures = list_pictures(input);
    return open_pictures(pictures, options, missing_numbers(input, pictures));
  }
  if (options.format.empty() && is_picture_file(input)) return open_pictures({input}, options);
  return open_stream(input, options);
}

}  // namespace

bool holds_one_picture(std::span<const std::byte> start, const std::string& name) {
  const auto format = image::detect_format(start);
  if (!format || is_called_motion_jpeg(name)) return false;
  const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
  return *format != image::ImageFormat::kPng || text.find("acTL") == std::string_view::npos;
}

VideoReader VideoReader::open(const std::string& input, const ReadOptions& options) {
  silence_libav();
  auto state = std::make_unique<ReaderState>();
  state->source = open_source(input, options);
  if (options.part != Part{}) state->source = open_part(std::move(state->source), options.part);
  return VideoReader(std::move(state));
}

VideoReader::VideoReader(std::unique_ptr<ReaderState> state) : state_(std::move(state)) {}
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;
VideoReader::~VideoReader() = default;

const StreamInfo& VideoReader::info() const {
  return state_->source->info();
}

std::vector<StreamEntry> VideoReader::streams() const {
  const AVFormatContext* format = state_->source->format();
  return format == nullptr ? std::vector<StreamEntry>() : list_streams(*format);
}

bool VideoReader::next(Frame& frame) {
  return state_->source->next(frame);
}

std::vector<Packet> VideoReader::remaining_packets() {
  return state_->source->take_packets();
}

std::vector<Packet> VideoReader::packets_until(double seconds) {
  return state_->source->packets_until(seconds);
}

const std::vector<std::string>& VideoReader::warnings() const {
  return state_->source->warnings().lines();
}

std::uint64_t VideoReader::damaged() const {
  return state_->source->damaged();
}

}  // namespace knotreel::video
