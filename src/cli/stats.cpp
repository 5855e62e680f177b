// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/stats.h"

#include "cli/metrics_report.h"

namespace knotreel::cli {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

void StageTimer::finish(const std::string& stage) {
  seconds_[stage] = running() - elsewhere_;
  start_ = Clock::now();
  elsewhere_ = 0;
}

double StageTimer::running() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void StageTimer::attribute(const std::string& stage, double seconds) {
  seconds_[stage] = seconds_.value(stage, 0.0) + seconds;
  elsewhere_ += seconds;
}

Json StageTimer::seconds() const {
  Json all = seconds_;
  double total = 0;
  for (const auto& [stage, seconds] : seconds_.items()) total += seconds.get<double>();
  all["total"] = total;
  return all;
}

Json features_json(const vectorize::Report& report) {
  return {{"chains", report.chains},         {"over_budget", report.chains_over_budget},
          {"corners", report.corners},       {"fine_grid", report.fine_grid},
          {"pixels", report.feature_pixels}, {"polyline_vertices", report.polyline_vertices},
          {"folds_left", report.folds_left}, {"dropped", report.features_dropped}};
}

Json rounds_json(const vectorize::Report& report) {
  Json rounds = Json::array();
  for (const vectorize::RoundReport& r : report.rounds) {
    Json milliseconds = Json::object();
    for (const auto& [stage, ms] : r.milliseconds) milliseconds[stage] = milliseconds.value(stage, 0.0) + ms;
    rounds.push_back({{"name", r.name},
                      {"knots", r.knots},
                      {"control_points", r.control_points},
                      {"mec", finite_or_null(r.mec)},
                      {"meg", finite_or_null(r.meg)},
                      {"psnr", finite_or_null(r.psnr)},
                      {"raw_bytes", r.raw_bytes},
                      {"milliseconds", std::move(milliseconds)}});
  }
  return rounds;
}

}  // namespace knotreel::cli
