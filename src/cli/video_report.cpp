// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/video_report.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "cli/command.h"
#include "cli/metrics_report.h"
#include "cli/standard_error.h"
#include "knotreel/base/error.h"

namespace knotreel::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kTerminalPause = 0.2;  // seconds
constexpr double kLogPause = 10;

std::string text_of(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string time_text(double seconds) {
  const auto s = static_cast<long>(std::lround(seconds));
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::string line_text(const pipeline::FrameRow& row, std::uint64_t frames) {
  const double done = static_cast<double>(row.index) + 1;
  const double fps = done / row.finished_seconds;
  std::string text = fmt::format("knotreel: frame {}", row.index + 1);
  if (frames > 0) text += fmt::format(" of {}", frames);
  text += fmt::format(", {:.2f} fps", fps);
  if (static_cast<double>(frames) > done) {
    text += ", ETA " + time_text((static_cast<double>(frames) - done) / fps);
  }
  if (row.psnr != 0) text += fmt::format(", PSNR {:.2f} dB", row.psnr);
  return text + fmt::format(", {} knots", row.knots);
}

Json milliseconds_json(const std::vector<std::pair<std::string, double>>& stages) {
  Json all = Json::object();
  for (const auto& [stage, ms] : stages) all[stage] = all.value(stage, 0.0) + ms;
  return all;
}

}  // namespace

VideoLine::VideoLine(std::uint64_t frames) : terminal_(shows_live_line()), frames_(frames) {}

VideoLine::~VideoLine() {
  if (terminal_) put_error(kClearLine);
}

void VideoLine::show(const pipeline::FrameRow& row) {
  if (is_quiet() || row.finished_seconds - shown_ < (terminal_ ? kTerminalPause : kLogPause)) return;
  shown_ = row.finished_seconds;
  const std::string text = line_text(row, frames_);
  put_error(terminal_ ? kClearLine + text : text + "\n");
}

ProgressFile::ProgressFile(const std::string& path, video::Rational time_base)
    : path_(path), time_base_(time_base) {
  if (path.empty()) return;
  const int flags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC;
  descriptor_ = path == "-" ? STDOUT_FILENO : ::open(path.c_str(), flags, 0666);
  if (descriptor_ < 0) {
    throw Error(ErrorKind::kOutput, "cannot write '" + path + "': " + std::strerror(errno));
  }
}

ProgressFile::~ProgressFile() {
  if (descriptor_ > STDERR_FILENO) ::close(descriptor_);
}

void ProgressFile::write(const std::string& text) {
  if (::write(descriptor_, text.data(), text.size()) == static_cast<ssize_t>(text.size())) return;
  const std::string why = "cannot write '" + path_ + "': " + std::strerror(errno);
  if (errno == EPIPE) throw BrokenPipe(ErrorKind::kOutput, why);
  throw Error(ErrorKind::kOutput, why);
}

void ProgressFile::show(const pipeline::FrameRow& row) {
  if (descriptor_ < 0) return;
  const double done = static_cast<double>(row.index) + 1;
  const double out_time = static_cast<double>(row.pts) * time_base_.value() * 1e6;
  last_ = fmt::format("frame={}\nfps={:.3f}\nout_time_us={}\npsnr={:.3f}\nknots={}\n", row.index + 1,
                      done / row.finished_seconds, std::llround(out_time), row.psnr, row.knots);
  write(last_ + "progress=continue\n");
}

void ProgressFile::end() {
  if (descriptor_ >= 0) write(last_ + "progress=end\n");
}

VideoStats::VideoStats(const std::string& path, const Json& head) {
  if (path.empty()) return;
  file_ = std::make_unique<OutputFile>(path);
  const std::string text = text_of(head, 2);
  file_->write(text.substr(0, text.size() - 2) + ",\n  \"frames\": [");
}

void VideoStats::add(const Json& row) {
  if (!file_) return;
  file_->write((first_ ? "\n    " : ",\n    ") + text_of(row, -1));
  first_ = false;
}

void VideoStats::finish(const Json& tail) {
  if (!file_) return;
  file_->write("\n  ],\n" + text_of(tail, 2).substr(2) + "\n");
  file_->commit();
}

Json changes_json(const track::MeshChanges& changes) {
  return {{"moved", changes.carry.moved},
          {"removed", changes.carry.removed},
          {"held", changes.carry.held},
          {"flips", changes.carry.flips},
          {"segments_dropped", changes.carry.segments_dropped},
          {"swapped", changes.swapped},
          {"inserted", changes.inserted},
          {"features_born", changes.features_born},
          {"repairs", changes.repairs}};
}

Json row_json(const pipeline::FrameRow& row) {
  return {{"frame", row.index},
          {"pts", row.pts},
          {"start", row.start},
          {"knots", row.knots},
          {"control_points", row.control_points},
          {"mec", finite_or_null(row.mec)},
          {"meg", finite_or_null(row.meg)},
          {"psnr", finite_or_null(row.psnr)},
          {"ssim", finite_or_null(row.ssim)},
          {"survival", row.survival},
          {"changes", changes_json(row.changes)},
          {"bytes", row.bytes},
          {"modelled", row.modelled_seconds},
          {"finished", row.finished_seconds},
          {"milliseconds", milliseconds_json(row.milliseconds)},
          {"model", milliseconds_json(row.model_milliseconds)}};
}

Json drawn_json(const pipeline::FrameRow& row) {
  return {{"frame", row.index},
          {"pts", row.pts},
          {"knots", row.knots},
          {"control_points", row.control_points},
          {"bytes", row.bytes},
          {"finished", row.finished_seconds},
          {"milliseconds", milliseconds_json(row.milliseconds)}};
}

Json summary_json(const pipeline::Summary& s) {
  return {{"frame_count", s.frames},
          {"keyframes", s.keyframes},
          {"seconds", s.seconds},
          {"cpu_seconds", s.cpu_seconds},
          {"fps", s.fps},
          {"first_frame_seconds", s.first_frame_seconds},
          {"psnr", finite_or_null(s.psnr)},
          {"mec", s.mec},
          {"meg", s.meg},
          {"ssim", s.ssim},
          {"knots", s.knots},
          {"control_points", s.control_points},
          {"survival", s.survival},
          {"document_bytes", s.document_bytes},
          {"interrupted", s.stopped}};
}

}  // namespace knotreel::cli
