// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "knotreel/vectorize/options.h"

/// The options of `knotreel vectorize` that say how a picture becomes a vector model.
namespace knotreel::cli {

/// What the user gave. A preset comes first whatever its place on the command line, and only what was given
/// replaces its values.
struct VectorizeOptions {
  std::string preset = "balanced";
  std::optional<std::string> max_control_points;
  std::optional<double> mec;
  std::optional<double> block_error;
  std::optional<double> meg;
  std::optional<int> rounds;
  std::optional<int> degree;
  std::optional<double> min_feature_length;
  std::optional<double> edge_threshold;
  std::optional<double> max_blur;
  std::optional<int> descent_steps;
  std::uint64_t seed = 1;
  bool no_features = false;
  bool no_fairing = false;
  std::optional<std::string> fine_grid;
  bool no_corner_detection = false;
  bool no_colour_correction = false;
  bool no_knot_optimisation = false;
  bool no_picture_links = false;
  bool no_smooth_corners = false;
};

/// What --max-control-points is if not given, in commands that take pictures and videos.
inline constexpr const char* kBoundOfPicturesAndVideos =
    "2.75%, of small pictures 20% up to 3000,\nof drawings 10% to 40%, of videos 2%,\n"
    "of small videos 20% up to 1500, with captions\n"
    "up to 10%; of drawn frames 2%, or 20% up to\n3000, or 10% (20% up to 50,000, 30% up to\n"
    "75,000) if their outlines ask for it";

/// Adds all of them to a command; `options` must live until it has been parsed.
/// @param default_bound  what --max-control-points is if not given, for the help.
void add_vectorize_options(CLI::App& command, VectorizeOptions& options, const std::string& default_bound);

/// Preset and options together, for a picture of so many pixels.
/// @param starts_group whether frames of a video are made from it.
/// @throws Error{kInvalidArgument} if the bound on control points is no number or share, or an option about
/// features comes with --no-features.
vectorize::Options effective_options(const VectorizeOptions& options, std::uint64_t pixels,
                                     bool starts_group = false);

/// Every setting that has a say in the result, as docs/stats.md tells.
nlohmann::ordered_json options_json(const vectorize::Options& options);

}  // namespace knotreel::cli
