#include "cli/bench/compare.h"

#include <fmt/core.h>

#include <cmath>
#include <map>

namespace knotreel::cli::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPsnrThreshold = 0.2;  // dB

std::string name_of(const Json& run) {
  return fmt::format("{} {} {}, threads: {}", run["clip"].get<std::string>(), run["size"].get<std::string>(),
                     run["preset"].get<std::string>(), run["threads"].get<int>());
}

std::map<std::string, Json> by_name(const Json& result) {
  std::map<std::string, Json> runs;
  for (const Json& run : result["runs"]) runs[name_of(run)] = run;
  return runs;
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

std::string comparison_text(const Json& before, const Json& after, double threshold) {
  std::string text = fmt::format("before: commit {}, {}\nafter:  commit {}, {}\n",
                                 before["commit"].get<std::string>(), before["date"].get<std::string>(),
                                 after["commit"].get<std::string>(), after["date"].get<std::string>());
  auto others = by_name(after);
  for (const Json& run : before["runs"]) {
    const auto other = others.extract(name_of(run));
    if (other.empty()) {
      text += "\n" + name_of(run) + ": only before\n";
      continue;
    }
    text += fmt::format("\n{:<44}{:>14}{:>14}{:>9}\n", name_of(run), "before", "after", "ratio");
    text += run_text(run, other.mapped(), threshold);
  }
  for (const auto& [name, run] : others) text += "\n" + name + ": only after\n";
  return text;
}

}  // namespace knotreel::cli::bench
