// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/trace.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "knotreel/base/error.h"

namespace knotreel::cli {
namespace {

using Json = nlohmann::ordered_json;
using Microseconds = std::chrono::duration<double, std::micro>;

constexpr const char* kHead = "{\"displayTimeUnit\": \"ms\", \"traceEvents\": [";
const std::string kColdStage = "cold";
constexpr const char* kTail = "\n]}\n";

std::string event(const std::string& name, double begin, double duration, int thread,
                  const pipeline::FrameRow& row) {
  const Json json{{"name", name},
                  {"ph", "X"},
                  {"ts", begin},
                  {"dur", duration},
                  {"pid", 1},
                  {"tid", thread},
                  {"args", {{"frame", row.index}, {"start", row.start}}}};
  return json.dump();
}

}  // namespace

Trace::Trace(const std::string& path) {
  if (path.empty()) return;
  if (path == "-")
    throw Error(ErrorKind::kInvalidArgument, "--trace needs a file: its end is written anew all the time");
  file_ = std::make_unique<OutputFile>(path);
  write(kHead);
}

void Trace::write(const std::string& events) {
  if (file_->seekable()) {
    const std::string text = events + kTail;  // at once, so that there is no moment without an end
    file_->write_at(end_, std::as_bytes(std::span(text)));
  } else {
    file_->write(events);
    file_->flush();
  }
  end_ += events.size();
}

void Trace::finish() {
  if (!file_) return;
  if (!file_->seekable()) file_->write(kTail);
  file_->commit();
}

void Trace::add(const pipeline::FrameRow& row) {
  if (!file_) return;
  const bool made_ahead = std::any_of(row.spans.begin(), row.spans.end(),
                                      [](const pipeline::StageSpan& s) { return s.stage == kColdStage; });
  std::string events;
  const auto put = [&](const std::string& name, double begin, double duration, int thread) {
    events += (first_ ? "\n" : ",\n") + event(name, begin, duration, thread, row);
    first_ = false;
  };
  for (const pipeline::StageSpan& span : row.spans) {
    double begin = Microseconds(span.begin - start_).count();
    const double end = Microseconds(span.end - start_).count();
    put(span.stage, begin, end - begin, span.thread);
    if (span.stage != "model") continue;
    // Its parts follow each other on the same thread; only how long they took is known.
    for (const auto& [part, milliseconds] : row.model_milliseconds) {
      if (made_ahead && (part == kColdStage || part == "measure")) continue;
      const double duration = std::min(1000 * milliseconds, end - begin);
      put(part, begin, duration, span.thread);
      begin += duration;
    }
  }
  write(events);
}

}  // namespace knotreel::cli
