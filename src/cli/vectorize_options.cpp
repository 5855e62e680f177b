// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/vectorize_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "cli/command.h"
#include "cli/parse.h"
#include "knotreel/base/error.h"

namespace knotreel::cli {
namespace {

const std::map<std::string, vectorize::Preset> kPresets{{"fast", vectorize::Preset::kFast},
                                                        {"balanced", vectorize::Preset::kBalanced},
                                                        {"fine", vectorize::Preset::kFine}};

const std::map<std::string, vectorize::FineGrid> kFineGrids{{"none", vectorize::FineGrid::kNone},
                                                            {"drawings", vectorize::FineGrid::kDrawings},
                                                            {"all", vectorize::FineGrid::kAll}};

std::string fine_grid_name(vectorize::FineGrid which) {
  return std::find_if(kFineGrids.begin(), kFineGrids.end(), [&](const auto& g) { return g.second == which; })
      ->first;
}

/// Numbers that an option may take.
struct Range {
  double low;
  double high;
};

/// @param defaults the value without this option, and where presets have others.
template <typename Number>
void add_number(CLI::App& command, const std::string& name, std::optional<Number>& value, const char* unit,
                Range range, const std::string& description, const std::string& defaults) {
  command
      .add_option(name, value,
                  fmt::format("{}({:g} to {:g}; default {})", description, range.low, range.high, defaults))
      ->check(within(range.low, range.high))
      ->type_name(unit);
}

template <typename Number>
std::string text_of(Number value) {
  return fmt::format("{:g}", double(value));
}

/// "4; fast: 0, fine: 40" for a setting that presets change.
template <class Get>
std::string by_preset(Get&& get) {
  return fmt::format("{}; fast: {}, fine: {}", get(preset_options(vectorize::Preset::kBalanced)),
                     get(preset_options(vectorize::Preset::kFast)),
                     get(preset_options(vectorize::Preset::kFine)));
}

void add_effort(CLI::App& command, VectorizeOptions& options, const std::string& default_bound) {
  const vectorize::Options defaults;
  command
      .add_option("--preset", options.preset,
                  "Time or quality: fast, balanced or fine. Sets --rounds, --descent-steps,\n"
                  "--max-blur, --fine-grid, the sweeps over the knots and whether the bound on\n"
                  "control points may grow; options given besides it win")
      ->check(CLI::IsMember(kPresets).description(""))
      ->type_name("NAME")
      ->capture_default_str();
  command
      .add_option("--max-control-points", options.max_control_points,
                  "Upper bound: a number, or a share of the pixels above 0%, at most 100%\n"
                  "(default " +
                      default_bound + ", but at least 256)")
      ->type_name("N|P%");
  add_number(command, "--mec", options.mec, "L", {0, 442},
             "Good enough: mean colour error per pixel, in levels of 0..255\n", text_of(defaults.mec));
  add_number(
      command, "--block-error", options.block_error, "TIMES", {0, 1000},
      "And the error of no part of 16x16 pixels is above so many times\nthat, so that nothing is left out "
      "of an easy picture; 0: parts do not count\n",
      text_of(defaults.block_error));
  add_number(command, "--meg", options.meg, "PX", {0, 1000},
             "Good enough: mean distance of features from their curves, in pixels\n", text_of(defaults.meg));
  add_number(command, "--rounds", options.rounds, "N", {1, 100},
             "Most rounds of fitting; each but the first adds knots where the error\nis large ",
             by_preset([](const auto& o) { return o.rounds; }) +
                 fmt::format("; {} in a video with warm start",
                             group_preset_options(vectorize::Preset::kBalanced).rounds));
  add_number(command, "--descent-steps", options.descent_steps, "N", {0, 1000},
             "Steps that move all knots against the true error at the end\n",
             by_preset([](const auto& o) { return o.descent_steps; }));
}

void add_features(CLI::App& command, VectorizeOptions& options) {
  const features::DetectOptions defaults = vectorize::Options{}.detect;
  add_number(command, "--edge-threshold", options.edge_threshold, "L", {0.1, 255},
             fmt::format("Least gradient of an edge, in levels of 0..255 per pixel; a feature needs\n"
                         "{:.2g} times as much somewhere\n",
                         defaults.anchor_threshold / defaults.edge_threshold),
             text_of(defaults.edge_threshold) + fmt::format("; {} for drawn pictures, not videos",
                                                            text_of(vectorize::Options{}.drawn_threshold)));
  add_number(command, "--min-feature-length", options.min_feature_length, "PX", {0, 100000},
             "Shorter features are dropped, in pixels ", text_of(defaults.min_length));
  add_number(command, "--max-blur", options.max_blur, "PX", {0, 100},
             "Wider edges are left to the smooth surface, in pixels; 0: none are;\nfine: 2 for drawings\n",
             by_preset([](const vectorize::Options& o) { return text_of(o.detect.max_blur); }));
  command.add_flag("--no-features", options.no_features, "Look for no features: smooth everywhere");
  command.add_flag("--no-fairing", options.no_fairing, "Leave the curves of features as they were found");
  command
      .add_option("--fine-grid", options.fine_grid,
                  "Find features on pixels of half the size, so that thin strokes and small letters\n"
                  "are drawn as such: none, drawings or all pictures, of up to 1.25 megapixels;\n"
                  "in two to three times the time and memory; in videos for drawn frames alone\n(default " +
                      by_preset([](const vectorize::Options& o) { return fine_grid_name(o.fine_grid); }) +
                      ")")
      ->check(CLI::IsMember(kFineGrids).description(""))
      ->type_name("WHICH");
  command.add_flag("--no-corner-detection", options.no_corner_detection,
                   "Leave the corners of features as round as they were found");
  command.add_flag("--no-colour-correction", options.no_colour_correction,
                   "Keep the mixed colours of the pixels beside features");
}

void add_surface(CLI::App& command, VectorizeOptions& options) {
  add_number(command, "--degree", options.degree, "N", {1, 3},
             "Degree of the splines: 1 makes flat triangles, 2 and 3 a smooth surface\n",
             text_of(vectorize::Options{}.degree));
  command.add_flag("--no-knot-optimisation", options.no_knot_optimisation,
                   "Leave knots where they were put, and joined as they are");
  command.add_flag("--no-picture-links", options.no_picture_links,
                   "Choose the links of knots by their places, not by the picture");
  command.add_flag("--no-smooth-corners", options.no_smooth_corners,
                   "Leave the surface merely continuous, not smooth, along the edges of the\n"
                   "knot mesh that run into ends and bends of features");
  command
      .add_option("--seed", options.seed,
                  "Kept in the statistics; the method draws no random numbers (0 to 2^63-1)")
      ->check(CLI::Range(std::int64_t{0}, std::numeric_limits<std::int64_t>::max()).description(""))
      ->type_name("N")
      ->capture_default_str();
}

template <typename Value>
void replace(Value& value, const std::optional<Value>& given) {
  if (given) value = *given;
}

}  // namespace

void add_vectorize_options(CLI::App& command, VectorizeOptions& options, const std::string& default_bound) {
  command.option_defaults()->group("Time and quality");
  add_effort(command, options, default_bound);
  command.option_defaults()->group("Features");
  add_features(command, options);
  command.option_defaults()->group("Surface");
  add_surface(command, options);
  command.option_defaults()->group("Options");
}

namespace {

void check_features_are_wanted(const VectorizeOptions& given) {
  if (!given.no_features) return;
  const std::pair<const char*, bool> about_features[] = {
      {"--edge-threshold", given.edge_threshold.has_value()},
      {"--min-feature-length", given.min_feature_length.has_value()},
      {"--max-blur", given.max_blur.has_value()},
      {"--fine-grid", given.fine_grid.has_value()},
      {"--meg", given.meg.has_value()}};
  for (const auto& [name, is_given] : about_features) {
    if (is_given)
      throw Error(ErrorKind::kInvalidArgument, std::string(name) + " is of no use with --no-features");
  }
}

}  // namespace

vectorize::Options effective_options(const VectorizeOptions& given, std::uint64_t pixels, bool starts_group) {
  check_features_are_wanted(given);
  const vectorize::Preset preset = kPresets.at(given.preset);
  vectorize::Options options =
      starts_group ? vectorize::group_preset_options(preset) : vectorize::preset_options(preset);
  // Otherwise it depends on the picture.
  if (given.max_control_points)
    options.max_control_points = parse_count("--max-control-points", *given.max_control_points, pixels);
  replace(options.mec, given.mec);
  replace(options.block_error, given.block_error);
  replace(options.meg, given.meg);
  replace(options.rounds, given.rounds);
  replace(options.degree, given.degree);
  replace(options.descent_steps, given.descent_steps);
  options.seed = given.seed;

  replace(options.detect.min_length, given.min_feature_length);
  replace(options.detect.max_blur, given.max_blur);
  if (given.max_blur) options.drawn_blur = 0;
  if (given.edge_threshold) {
    options.drawn_threshold = 0;
    // Hysteresis keeps its proportion.
    options.detect.anchor_threshold *= *given.edge_threshold / options.detect.edge_threshold;
    options.detect.edge_threshold = *given.edge_threshold;
  }

  options.features = !given.no_features;
  options.fairing = !given.no_fairing;
  if (given.fine_grid) options.fine_grid = kFineGrids.at(*given.fine_grid);
  options.corner_detection = !given.no_corner_detection;
  options.colour_correction = !given.no_colour_correction;
  options.picture_links = !given.no_picture_links;
  options.colour.smooth_corners = !given.no_smooth_corners;
  if (given.no_knot_optimisation) {
    options.optimise.positions = false;
    options.optimise.connectivity = false;
  }
  return options;
}

nlohmann::ordered_json options_json(const vectorize::Options& o) {
  return {{"degree", o.degree},
          {"mec", o.mec},
          {"block_error", o.block_error},
          {"meg", o.meg},
          {"rounds", o.rounds},
          {"max_control_points", o.max_control_points},
          {"first_share", o.first_share},
          {"longest_edge", o.longest_edge},
          {"feature_share", o.feature_share},
          {"weak_share", o.weak_share},
          {"drawn_weak_share", o.drawn_weak_share},
          {"max_turning", o.max_turning},
          {"descent_steps", o.descent_steps},
          {"seed", o.seed},
          {"features", o.features},
          {"fairing", o.fairing},
          {"corner_detection", o.corner_detection},
          {"colour_correction", o.colour_correction},
          {"picture_links", o.picture_links},
          {"smooth_corners", o.colour.smooth_corners},
          {"clear_curves", o.clear_curves},
          {"clear_inside", o.clear_inside},
          {"fine_grid", fine_grid_name(o.fine_grid)},
          {"detect",
           {{"smoothing", o.detect.smoothing},
            {"edge_threshold", o.detect.edge_threshold},
            {"anchor_threshold", o.detect.anchor_threshold},
            {"min_length", o.detect.min_length},
            {"min_weight", o.detect.min_weight},
            {"max_blur", o.detect.max_blur},
            {"euclidean_magnitude", o.detect.euclidean_magnitude}}},
          {"drawn_blur", o.drawn_blur},
          {"drawn_threshold", o.drawn_threshold},
          {"drawn_distance", o.drawn_distance},
          {"fair",
           {{"lambda", o.fair.lambda},
            {"iterations", o.fair.iterations},
            {"keep_size", o.fair.keep_size},
            {"max_shift", o.fair.max_shift}}},
          {"corners", {{"least_turn", o.corners.least_turn}, {"most_error", o.corners.most_error}}},
          {"correction",
           {{"one_ring", o.correction.one_ring},
            {"two_ring", o.correction.two_ring},
            {"clean_only", o.correction.clean_only},
            {"strength", o.correction.strength}}},
          {"parametrize",
           {{"polyline_distance", o.parametrize.polyline_distance},
            {"polyline_bulge", o.parametrize.polyline_bulge},
            {"decay", o.parametrize.decay},
            {"tolerance", o.parametrize.tolerance}}},
          {"segment_knot_spacing", o.segment_knot_spacing},
          {"optimise",
           {{"rounds", o.optimise.rounds},
            {"steps", o.optimise.steps},
            {"alpha", o.optimise.alpha},
            {"least_angle", o.optimise.least_angle},
            {"min_distance", o.optimise.min_distance},
            {"positions", o.optimise.positions},
            {"connectivity", o.optimise.connectivity}}},
          {"colour", {{"ridge", o.colour.ridge}}},
          {"geometry",
           {{"feature_weight", o.geometry.feature_weight},
            {"joint_weight", o.geometry.joint_weight},
            {"ridge", o.geometry.ridge},
            {"least", o.geometry.least}}},
          {"mixed_weight", o.mixed_weight}};
}

}  // namespace knotreel::cli
