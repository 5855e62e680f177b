#include "knotreel/video/reader.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/image/format.h"
#include "picture_list.h"
#include "source.h"
#include "stream_description.h"

namespace knotreel::video {
namespace {

/// A file that holds one picture of a kind that the image module reads. Animated PNG is a video.
bool holds_picture(const std::string& input) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(input, ignored)) return false;
  const std::vector<std::byte> start = read_start(input, 4096);
  const auto format = image::detect_format(start);
  if (!format) return false;
  const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
  return *format != image::ImageFormat::kPng || text.find("acTL") == std::string_view::npos;
}

std::unique_ptr<Source> open_source(const std::string& input, const ReadOptions& options) {
  if (means_pictures(input)) return open_pictures(list_pictures(input), options);
  if (options.format.empty() && holds_picture(input)) return open_pictures({input}, options);
  return open_stream(input, options);
}

}  // namespace

VideoReader VideoReader::open(const std::string& input, const ReadOptions& options) {
  silence_libav();
  auto state = std::make_unique<ReaderState>();
  state->source = open_source(input, options);
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
