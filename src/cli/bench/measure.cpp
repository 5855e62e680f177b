// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench/measure.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include "cli/bench/child.h"

namespace knotreel::cli::bench {
namespace {

using Json = nlohmann::ordered_json;
using Arguments = std::vector<std::string>;

Json read_json(const std::string& path) {
  std::ifstream file(path);
  return Json::parse(file);
}

Arguments joined(Arguments all, const Arguments& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

void add_stages(Json& sums, const Json& row) {
  for (const auto& [stage, milliseconds] : row.items()) {
    sums[stage] = sums.value(stage, 0.0) + milliseconds.get<double>();
  }
}

void divide(Json& sums, double count) {
  for (auto& sum : sums) sum = sum.get<double>() / count;
}

/// Frames per second of decoding and encoding alone.
double passthrough_fps(const Clip& clip, const Setting& setting, int threads, double frames,
                       const Scratch& scratch) {
  const Arguments arguments{"bench",         clip.path,
                            "--passthrough", scratch.path("passthrough.mp4"),
                            "--threads",     std::to_string(threads)};
  return frames / std::stod(run_self(joined(arguments, setting.encoding), scratch).output);
}

Json measure_run(const Clip& clip, const Setting& setting, int threads, const Scratch& scratch) {
  const std::string video = scratch.path("out.mp4");
  const std::string stats_file = scratch.path("stats.json");
  Arguments arguments{"transcode",
                      clip.path,
                      "--no-copy-streams",
                      "-o",
                      video,
                      "--document",
                      scratch.path("out.tcb"),
                      "--stats",
                      stats_file,
                      "--preset",
                      setting.preset,
                      "--threads",
                      std::to_string(threads)};
  arguments = joined(joined(arguments, setting.encoding), setting.vectorization);
  const ChildResult child = run_self(arguments, scratch);
  const Json stats = read_json(stats_file);
  const double frames = stats.at("frame_count");
  const double passthrough = passthrough_fps(clip, setting, threads, frames, scratch);
  const double seconds = stats.at("seconds");
  return {{"clip", clip.name},
          {"size", std::to_string(clip.width) + "x" + std::to_string(clip.height)},
          {"preset", setting.preset},
          {"threads", threads},
          {"frames", stats.at("frame_count")},
          {"keyframes", stats.at("keyframes")},
          {"seconds", seconds},
          {"start_and_end_seconds", child.seconds - seconds},
          {"fps", stats.at("fps")},
          {"passthrough_fps", passthrough},
          {"share_of_passthrough", frames / seconds / passthrough},
          {"first_frame_seconds", stats.at("first_frame_seconds")},
          {"busy_cores", stats.at("cpu_seconds").get<double>() / seconds},
          {"peak_memory_bytes", stats.at("peak_memory_bytes")},
          {"knots", stats.at("knots")},
          {"control_points", stats.at("control_points")},
          {"document_bytes_per_frame", stats.at("document_bytes").get<double>() / frames},
          {"video_bytes_per_frame", double(std::filesystem::file_size(video)) / frames},
          {"psnr", stats.at("psnr")},
          {"ssim", stats.at("ssim")},
          {"cold", frames_json(stats, false)},
          {"warm", frames_json(stats, true)}};
}

/// The same for any number of threads, so once is enough.
void add_flicker(Json& runs, const Clip& clip, const Scratch& scratch) {
  const Arguments arguments{"compare", clip.path, scratch.path("out.tcb"), "--json"};
  const Json figures = Json::parse(run_self(arguments, scratch).output);
  for (Json& run : runs) {
    run["flicker"] = figures["flicker"];
    run["warped_flicker"] = figures["warped_flicker"];
  }
}

Json ratio(const Json& figure, const Json& first) {
  if (!figure.is_number() || !first.is_number()) return nullptr;
  return figure.get<double>() / first.get<double>();
}

}  // namespace

Json frames_json(const Json& stats, bool warm) {
  Json stages = Json::object();
  Json parts = Json::object();
  double count = 0;
  double seconds = 0;
  double before = 0;
  // Models of different stretches may be ready in another order than that of the frames.
  std::vector<Json> rows = stats.at("frames");
  const auto sooner = [](const Json& a, const Json& b) { return a["modelled"] < b["modelled"]; };
  std::stable_sort(rows.begin(), rows.end(), sooner);
  for (const Json& row : rows) {
    if ((row["start"] == "warm") == warm) {
      ++count;
      seconds += row["modelled"].get<double>() - before;
      add_stages(stages, row["milliseconds"]);
      add_stages(parts, row["model"]);
    }
    before = row["modelled"];
  }
  divide(stages, count);
  divide(parts, count);
  // What is left to do after the last model belongs to all frames.
  seconds += (stats.at("seconds").get<double>() - before) * count / stats.at("frame_count").get<double>();
  return {{"frames", count},
          {"fps", count > 0 ? Json(count / seconds) : Json(nullptr)},
          {"milliseconds", stages},
          {"model_milliseconds", parts}};
}

Json measure_clip(const Clip& clip, const Setting& setting, const Scratch& scratch) {
  Json runs = Json::array();
  for (const int threads : setting.threads) runs.push_back(measure_run(clip, setting, threads, scratch));
  for (Json& run : runs) {
    run["speedup"] = ratio(run["fps"], runs.front()["fps"]);
    run["warm_speedup"] = ratio(run["warm"]["fps"], runs.front()["warm"]["fps"]);
  }
  add_flicker(runs, clip, scratch);
  return runs;
}

}  // namespace knotreel::cli::bench
