// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/trace.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

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

int open_file(const std::string& path) {
  if (path == "-")
    throw Error(ErrorKind::kInvalidArgument, "--trace needs a file: its end is written anew all the time");
  return path.empty() ? -1 : ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

}  // namespace

Trace::Trace(const std::string& path) : Trace(path, open_file(path)) {
  if (!path.empty()) write(kHead);
}

Trace::~Trace() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Trace::write(const std::string& events) {
  const std::string text = events + kTail;
  // A disk that is nearly full takes a part of it, and tells why with the rest.
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = descriptor_ < 0 ? -1
                                            : ::pwrite(descriptor_, text.data() + done, text.size() - done,
                                                       end_ + static_cast<std::int64_t>(done));
    if (written < 0) throw Error(ErrorKind::kOutput, "cannot write '" + path_ + "': " + std::strerror(errno));
    done += static_cast<std::size_t>(written);
  }
  end_ += static_cast<std::int64_t>(events.size());
}

void Trace::add(const pipeline::FrameRow& row) {
  if (descriptor_ < 0) return;
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
