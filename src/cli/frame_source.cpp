// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/frame_source.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "cli/pictures.h"
#include "cli/standard_input.h"
#include "cli/video_run.h"
#include "knotreel/base/input_file.h"

namespace knotreel::cli {
namespace {

// "\x89TCB"
constexpr std::array kMagic{std::byte{0x89}, std::byte{'T'}, std::byte{'C'}, std::byte{'B'}};

class VideoFrames : public FrameSource {
 public:
  VideoFrames(const std::string& path, video::ReadOptions options)
      : reader_(video::VideoReader::open(path, pictures_only(std::move(options)))),
        turn_(video::turn_of(reader_.info())) {}

  bool next(image::Image& image) override {
    video::Frame frame;
    if (!reader_.next(frame)) return false;
    image = video::turned(frame.image, turn_);
    return true;
  }
  std::vector<std::string> warnings() const override { return reader_.warnings(); }

 private:
  static video::ReadOptions pictures_only(video::ReadOptions options) {
    options.copy_streams = false;
    return options;
  }

  video::VideoReader reader_;
  Turn turn_;
};

class DocumentFrames : public FrameSource {
 public:
  explicit DocumentFrames(const std::string& path) : reader_(open_document(path)), turn_(turn_of(reader_)) {}

  bool next(image::Image& image) override {
    if (next_ == reader_.frame_count()) return false;
    image = video::turned(render_whole(reader_.read(next_++), {}), turn_);
    return true;
  }

 private:
  document::Reader reader_;
  Turn turn_;
  std::size_t next_ = 0;
};

}  // namespace

bool is_document(const std::string& path) {
  std::error_code ignored;
  if (path != "-" && !std::filesystem::is_regular_file(path, ignored)) return false;
  return begins_document(path == "-" ? peek_standard_input(kMagic.size()) : read_start(path, kMagic.size()));
}

bool begins_document(std::span<const std::byte> bytes) {
  return bytes.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin());
}

bool has_frames(const std::string& path) {
  if (path == "-") return false;
  if (is_document(path)) return document::Reader::open(path).frame_count() > 1;
  return !path.ends_with(".tcb") && is_video(path, {});
}

std::unique_ptr<FrameSource> open_frames(const std::string& path, const video::ReadOptions& options) {
  if (is_document(path)) return std::make_unique<DocumentFrames>(path);
  return std::make_unique<VideoFrames>(path, options);
}

}  // namespace knotreel::cli
