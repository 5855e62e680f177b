// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench/tables.h"

#include <fmt/core.h>

#include <vector>

#include "cli/printable.h"

namespace knotreel::cli::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStages[] = {"decode", "analyse",   "cold",      "curves",
                                   "model",  "documents", "rasterize", "encode"};

struct Figure {
  const char* label;
  const char* pointer;  ///< in the JSON of a run
  double scale = 1;
  int decimals = 2;
};

const Figure kFigures[] = {{"fps", "/fps"},
                           {"fps warm", "/warm/fps"},
                           {"fps passthrough", "/passthrough_fps", 1, 1},
                           {"share of it, %", "/share_of_passthrough", 100, 1},
                           {"speed-up", "/speedup"},
                           {"speed-up warm", "/warm_speedup"},
                           {"busy cores", "/busy_cores"},
                           {"first frame, s", "/first_frame_seconds"},
                           {"start and end, s", "/start_and_end_seconds"},
                           {"peak MB", "/peak_memory_bytes", 1e-6, 0},
                           {"bytes/frame", "/document_bytes_per_frame", 1, 0},
                           {"keyframes", "/keyframes", 1, 0},
                           {"PSNR", "/psnr"},
                           {"flicker", "/flicker", 1, 3},
                           {"warped flicker", "/warped_flicker", 1, 3}};

/// What is missing or null (a PSNR of equal pictures, figures of warm frames if there are none) is a dash.
std::string figure_text(const Json& run, const Figure& figure) {
  const Json value = run.value(Json::json_pointer(figure.pointer), Json(nullptr));
  return value.is_number() ? fmt::format("{:.{}f}", figure.scale * value.get<double>(), figure.decimals)
                           : "-";
}

std::string line_text(const Json& runs, const Figure& figure) {
  std::string line = fmt::format("  {:<22}", figure.label);
  for (const Json& run : runs) line += fmt::format("{:>12}", figure_text(run, figure));
  return line + "\n";
}

/// Times of the stages, then of the parts of the stage "model".
std::string stages_text(const Json& runs, const std::string& kind) {
  if (runs.front()[kind]["frames"] == 0) return {};
  std::string text = "  ms per " + kind + " frame\n";
  for (const std::string group : {"milliseconds", "model_milliseconds"}) {
    const std::string indent = group == "milliseconds" ? "  " : "    ";
    for (const auto& [stage, ignored] : runs.front()[kind][group].items()) {
      const std::string label = indent + stage;
      const std::string pointer = "/" + kind + "/" + group + "/" + stage;
      text += line_text(runs, {label.c_str(), pointer.c_str(), 1, 1});
    }
  }
  return text;
}

std::string row_of(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += " " + cell + " |";
  return row + "\n";
}

std::string head_of(const std::vector<std::string>& cells) {
  return row_of(cells) + row_of(std::vector<std::string>(cells.size(), "---"));
}

std::vector<std::string> key_cells(const Json& run) {
  return {printable(run["clip"].get<std::string>()), run["size"], run["preset"],
          fmt::format("{}", run["threads"].get<int>())};
}

const std::vector<std::string> kKeys{"clip", "size", "preset", "threads"};

std::string figures_table(const Json& runs) {
  std::vector<std::string> head = kKeys;
  for (const Figure& figure : kFigures) head.push_back(figure.label);
  std::string table = head_of(head);
  for (const Json& run : runs) {
    std::vector<std::string> cells = key_cells(run);
    for (const Figure& figure : kFigures) cells.push_back(figure_text(run, figure));
    table += row_of(cells);
  }
  return table;
}

/// "cold / warm" for each stage.
std::string stages_table(const Json& runs) {
  std::vector<std::string> head = kKeys;
  head.insert(head.end(), std::begin(kStages), std::end(kStages));
  std::string table = head_of(head);
  for (const Json& run : runs) {
    std::vector<std::string> cells = key_cells(run);
    for (const std::string stage : kStages) {
      const std::string cold = "/cold/milliseconds/" + stage;
      const std::string warm = "/warm/milliseconds/" + stage;
      cells.push_back(figure_text(run, {"", cold.c_str(), 1, 1}) + " / " +
                      figure_text(run, {"", warm.c_str(), 1, 1}));
    }
    table += row_of(cells);
  }
  return table;
}

}  // namespace

std::string surroundings_text(const Json& result) {
  const Json& machine = result["machine"];
  return fmt::format("{}, {} cores, {:.0f} GB, load before {:.1f}; {}, {}; commit {}, {}\n",
                     machine["cpu"].get<std::string>(), machine["cores"].get<int>(),
                     1e-9 * machine["memory_bytes"].get<double>(), machine["load_before"].get<double>(),
                     result["compiler"]["name"].get<std::string>(),
                     result["compiler"]["flags"].get<std::string>(), result["commit"].get<std::string>(),
                     result["date"].get<std::string>());
}

std::string runs_text(const Json& runs) {
  const Json& first = runs.front();
  std::string text =
      fmt::format("\n{} {}, {} frames, {}\n  {:<22}", printable(first["clip"].get<std::string>()),
                  first["size"].get<std::string>(), first["frames"].get<int>(),
                  first["preset"].get<std::string>(), "threads");
  for (const Json& run : runs) text += fmt::format("{:>12}", run["threads"].get<int>());
  text += "\n";
  for (const Figure& figure : kFigures) text += line_text(runs, figure);
  return text + stages_text(runs, "cold") + stages_text(runs, "warm");
}

std::string markdown(const Json& result) {
  return surroundings_text(result) + "\n" + figures_table(result["runs"]) +
         "\nMilliseconds per frame, cold / warm:\n\n" + stages_table(result["runs"]);
}

}  // namespace knotreel::cli::bench
