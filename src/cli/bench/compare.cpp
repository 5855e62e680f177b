// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench/compare.h"

#include <fmt/core.h>

#include <cmath>
#include <map>

#include "cli/printable.h"

namespace knotreel::cli::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPsnrThreshold = 0.2;  // dB

std::string name_of(const Json& run) {
  return fmt::format("{} {} {}, threads: {}", run.at("clip").get<std::string>(),
                     run.at("size").get<std::string>(), run.at("preset").get<std::string>(),
                     run.at("threads").get<int>());
}

bool differs(const std::string& figure, double before, double after, double threshold) {
  if (figure == "/psnr") return std::abs(after - before) > kPsnrThreshold;
  return std::abs(after - before) > threshold * std::abs(before);
}

std::string line_text(const std::string& figure, double before, double after, double threshold) {
  const double ratio = before == after ? 1 : after / before;
  return fmt::format("  {:<42}{:>14.3f}{:>14.3f}{:>9.3f}{}\n", figure.substr(1), before, after, ratio,
                     differs(figure, before, after, threshold) ? " *" : "");
}

std::string run_text(const Json& before, const Json& after, double threshold) {
  std::string text;
  const Json flat_before = before.flatten();
  const Json flat_after = after.flatten();
  for (const auto& [figure, value] : flat_before.items()) {
    const auto other = flat_after.find(figure);
    if (figure == "/threads" || !value.is_number() || other == flat_after.end() || !other->is_number())
      continue;
    text += line_text(figure, value, *other, threshold);
  }
  return text;
}

}  // namespace

Result result_of(const Json& json) {
  Result result{
      printable(json.at("commit").get<std::string>()), printable(json.at("date").get<std::string>()), {}};
  for (const Json& run : json.at("runs")) result.runs.push_back({printable(name_of(run)), run});
  return result;
}

std::string comparison_text(const Result& before, const Result& after, double threshold) {
  std::string text = fmt::format("before: commit {}, {}\nafter:  commit {}, {}\n", before.commit, before.date,
                                 after.commit, after.date);
  std::map<std::string, Json> others;
  for (const Result::Run& run : after.runs) others[run.name] = run.figures;
  for (const Result::Run& run : before.runs) {
    const auto other = others.extract(run.name);
    if (other.empty()) {
      text += "\n" + run.name + ": only before\n";
      continue;
    }
    text += fmt::format("\n{:<44}{:>14}{:>14}{:>9}\n", run.name, "before", "after", "ratio");
    text += run_text(run.figures, other.mapped(), threshold);
  }
  for (const auto& [name, run] : others) text += "\n" + name + ": only after\n";
  return text;
}

}  // namespace knotreel::cli::bench
