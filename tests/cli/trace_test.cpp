// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <thread>

#include "cli/trace.h"
#include "knotreel/base/error.h"
#include "program.h"
#include "support/clips.h"

namespace knotreel {
namespace {

using nlohmann::json;
using test::expect_success;
using test::knotreel;
using test::read_text;

constexpr int kTraceFrames = 6;
constexpr double kRounding = 0.01;  // microseconds

/// A folder with a small video, and the trace of a run.
class CliTrace : public testing::Test {
 protected:
  CliTrace() { test::write_clip(clip_, kTraceFrames); }

  std::string path(const std::string& name) const { return (dir_ / name).string(); }
  json events() const { return json::parse(read_text(trace_))["traceEvents"]; }

  /// The file that a trace is until it gets its name; empty if there is none.
  std::string unfinished_trace() const {
    for (const auto& entry : std::filesystem::directory_iterator(dir_ / "")) {
      const std::string file = entry.path().string();
      if (file.starts_with(trace_ + ".") && file.ends_with(".part")) return file;
    }
    return "";
  }

  json traced_transcode() {
    expect_success(knotreel({"transcode", clip_, "-f", "null", "--preset", "fast", "--trace", trace_,
                             "--stats", path("s.json")}));
    return events();
  }

  test::TempDir dir_;
  std::string clip_ = (dir_ / "clip.mkv").string();
  std::string trace_ = (dir_ / "t.json").string();
};

double begin_of(const json& event) {
  return event["ts"].get<double>();
}
double end_of(const json& event) {
  return begin_of(event) + event["dur"].get<double>();
}
bool within(const json& inner, const json& outer) {
  return inner["tid"] == outer["tid"] && inner["args"]["frame"] == outer["args"]["frame"] &&
         begin_of(inner) >= begin_of(outer) - kRounding && end_of(inner) <= end_of(outer) + kRounding;
}

std::size_t open_files() {
  return std::size_t(std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                                   std::filesystem::directory_iterator()));
}

TEST(Trace, AFullDiskLeavesNothingOpen) {
  const std::size_t before = open_files();
  EXPECT_THROW(cli::Trace("/dev/full"), Error);
  EXPECT_EQ(open_files(), before);
}

TEST_F(CliTrace, EveryStageOfEveryFrameIsOneEvent) {
  std::map<std::pair<std::string, int>, int> count;
  const json all = traced_transcode();
  const json stats = json::parse(read_text(path("s.json")));
  for (const json& event : all) {
    const int frame = event["args"]["frame"];
    ++count[{event["name"], frame}];
    EXPECT_EQ(event["ph"], "X");
    EXPECT_GE(begin_of(event), 0);
    EXPECT_GE(event["dur"].get<double>(), 0);
    EXPECT_EQ(event["args"]["start"], stats["frames"][std::size_t(frame)]["start"]);
  }
  for (int frame = 0; frame < kTraceFrames; ++frame) {
    for (const char* stage : {"decode", "analyse", "model", "documents", "rasterize", "encode"}) {
      EXPECT_EQ((count[{stage, frame}]), 1) << stage << ' ' << frame;
    }
    EXPECT_EQ((count[{"cold", frame}]), frame == 0 ? 1 : 0);
  }
}

TEST_F(CliTrace, EventsOfOneThreadAreNestedOrApart) {
  const json all = traced_transcode();
  for (const json& a : all) {
    for (const json& b : all) {
      if (a["tid"] != b["tid"] || begin_of(a) > begin_of(b)) continue;
      const bool apart = end_of(a) <= begin_of(b) + kRounding;
      const bool nested = end_of(b) <= end_of(a) + kRounding;
      const bool nested_the_other_way = begin_of(b) <= begin_of(a) + kRounding;
      EXPECT_TRUE(apart || nested || nested_the_other_way) << a << '\n' << b;
    }
  }
}

TEST_F(CliTrace, PartsOfTheModelLieWithinIt) {
  const json all = traced_transcode();
  const std::vector<std::string> stages{"decode", "analyse",   "cold",      "curves",
                                        "model",  "documents", "rasterize", "encode"};
  std::size_t parts = 0;
  for (const json& event : all) {
    if (std::count(stages.begin(), stages.end(), event["name"]) > 0) continue;
    ++parts;
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const json& model) {
      return model["name"] == "model" && within(event, model);
    })) << event;
  }
  EXPECT_GT(parts, std::size_t{kTraceFrames});
}

TEST_F(CliTrace, VectorizeHasOneToo) {
  expect_success(knotreel({"vectorize", clip_, "-o", path("o.tcb"), "--preset", "fast", "--trace", trace_}));
  EXPECT_FALSE(events().empty());
}

TEST_F(CliTrace, ItIsWholeAfterAnySignal) {
  test::write_clip(clip_, 400);
  for (const int signal : {SIGINT, SIGKILL}) {
    test::write_text(trace_, "before");
    const auto result = knotreel({"transcode", clip_, "-f", "null", "--preset", "fast", "--trace", trace_,
                                  "--document", path("o.tcb")},
                                 {.signal_once = path("o.tcb."), .signal = signal});
    EXPECT_EQ(result.exit_code, 128 + signal) << result.err;
    const std::string unfinished = unfinished_trace();
    EXPECT_EQ(unfinished.empty(), signal == SIGINT);
    EXPECT_EQ(read_text(trace_) == "before", signal == SIGKILL);
    const std::string written = signal == SIGINT ? trace_ : unfinished;
    EXPECT_TRUE(json::parse(read_text(written))["traceEvents"].is_array());
  }
}

TEST_F(CliTrace, AFailureLeavesWhatWasThere) {
  test::write_text(trace_, "before");
  test::expect_failure(
      knotreel({"transcode", clip_, "-o", "/dev/full", "-f", "nut", "--preset", "fast", "--trace", trace_}),
      4);
  EXPECT_EQ(read_text(trace_), "before");
  EXPECT_EQ(unfinished_trace(), "");
}

TEST_F(CliTrace, APipeHasItWithOneEnd) {
  const std::string pipe = path("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string text;
  std::thread reader([&] { text = read_text(pipe); });
  expect_success(knotreel({"transcode", clip_, "-f", "null", "--preset", "fast", "--trace", pipe}));
  reader.join();
  EXPECT_FALSE(json::parse(text)["traceEvents"].empty());
}

TEST_F(CliTrace, WhereNoneCanBeWrittenIsExit4) {
  const auto result = knotreel({"transcode", clip_, "-f", "null", "--trace", path("no/t.json")});
  test::expect_failure(result, 4);
  EXPECT_NE(result.err.find("No such file or directory"), std::string::npos) << result.err;
  test::expect_failure(knotreel({"transcode", clip_, "-f", "null", "--trace", "/dev/full"}), 4);
}

TEST_F(CliTrace, StandardOutputCannotBeOne) {
  test::expect_failure(knotreel({"transcode", clip_, "-f", "null", "--trace", "-"}), 2);
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST_F(CliTrace, TheSummaryTellsHowBusyTheCoresWere) {
  const auto result = knotreel({"transcode", clip_, "-f", "null", "--preset", "fast"});
  expect_success(result);
  EXPECT_NE(result.out.find(" fps), busy "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find(" cores, "), std::string::npos) << result.out;
}

}  // namespace
}  // namespace knotreel
