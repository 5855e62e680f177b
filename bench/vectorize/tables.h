// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "knotreel/vectorize/vectorize.h"

/// Tables of docs/benchmarks.md about whole pictures, printed as Markdown.
namespace knotreel::bench {

struct Picture {
  std::string name;
  image::Image image;
};

/// What a run came to.
struct Outcome {
  vectorize::Report report;
  double psnr = 0;        ///< dB, rendered at 1x against the picture
  double psnr_edges = 0;  ///< dB, of the pixels within two of a feature of the reference run
  double mec = 0;         ///< levels
  double seconds = 0;
  std::size_t control_points = 0;
  std::size_t raw_bytes = 0;
  std::size_t file_bytes = 0;
};

/// @param near  per pixel 1 if it counts for psnr_edges; empty: none does.
Outcome measure(const image::Image& picture, const vectorize::Options& options,
                const std::vector<std::uint8_t>& near = {});

/// PSNR at 0.5, 1, 2 and 4 % control points per pixel; each beside a C0 linear mesh of as many raw bytes.
void print_curves(const std::vector<Picture>& pictures);

/// Default and fine preset at the default number of control points, with bytes and times.
void print_presets(const std::vector<Picture>& pictures);

/// What each part of the method brings.
void print_ablation(const std::vector<Picture>& pictures);

/// Milliseconds by stage and round.
void print_stages(const std::vector<Picture>& pictures);

/// Time against the number of pixels (enlarged copies) and of control points.
void print_scaling(const std::vector<Picture>& pictures);

}  // namespace knotreel::bench
