// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/vectorize/options.h"

#include <algorithm>
#include <limits>

#include "knotreel/features/captions.h"
#include "knotreel/features/flat_share.h"
#include "knotreel/spline/space.h"

namespace knotreel::vectorize {

namespace {

constexpr std::size_t kMostOfSmall = 3'000;
constexpr std::size_t kMostOfSmallFilm = 1'500;
constexpr double kShareOfSmall = 0.2;
constexpr double kShareOfVideo = 0.02;
constexpr double kShareOfDrawings = 0.1;
constexpr double kMostOfPage = 0.4;
constexpr std::size_t kMostOfDrawings = 200'000;
constexpr std::size_t kMostOfSmallDense = 50'000;
constexpr double kShareOfSmallCramped = 0.3;
constexpr std::size_t kMostOfSmallCramped = 75'000;

std::size_t share_of(std::uint64_t pixels, double share) {
  return std::max<std::size_t>(256, static_cast<std::size_t>(share * static_cast<double>(pixels)));
}

/// A share of the pixels, or of small pictures a larger one, up to some number.
std::size_t share_or_more(std::uint64_t pixels, double share, std::size_t most_of_small) {
  return std::max(share_of(pixels, share), std::min(most_of_small, share_of(pixels, kShareOfSmall)));
}

/// From 10 % to 40 %: what is not flat is drawn densely, such as a page of text; but 10 % where more than
/// that is not flat, which are photographs, shades and noise.
double share_of_drawing(const image::Image& picture) {
  const double share = 2 * (1 - features::flat_share(picture)) - 0.4;
  return share > kMostOfPage ? kShareOfDrawings : std::max(kShareOfDrawings, share);
}

}  // namespace

std::size_t with_captions(const image::Image& picture, std::size_t usual, std::size_t most) {
  return std::max(usual, std::min(most, usual + features::caption_pixels(picture)));
}

std::size_t default_control_points(const image::Image& picture) {
  const std::uint64_t pixels = picture.pixel_count();
  const std::size_t of_any = share_or_more(pixels, 0.0275, kMostOfSmall);
  if (of_any >= kMostOfDrawings) return of_any;
  if (!features::is_drawing(picture))
    return with_captions(picture, of_any, std::min(kMostOfDrawings, share_of(pixels, kShareOfDrawings)));
  return std::max(of_any, std::min(kMostOfDrawings, share_of(pixels, share_of_drawing(picture))));
}

std::size_t default_control_points_with_features(const image::Image& picture) {
  const double share = features::is_drawing(picture) ? kMostOfPage : kShareOfDrawings;
  return std::max(default_control_points(picture),
                  std::min(kMostOfDrawings, share_of(picture.pixel_count(), share)));
}

std::size_t default_video_control_points(std::uint64_t pixels) {
  return share_or_more(pixels, kShareOfVideo, kMostOfSmallFilm);
}

std::size_t default_drawn_video_control_points(std::uint64_t pixels) {
  return share_or_more(pixels, kShareOfVideo, kMostOfSmall);
}

std::size_t default_dense_video_control_points(std::uint64_t pixels) {
  return std::max(default_drawn_video_control_points(pixels),
                  std::min(kMostOfDrawings, share_of(pixels, kShareOfDrawings)));
}

std::size_t default_dense_drawn_video_control_points(std::uint64_t pixels) {
  return std::max(default_dense_video_control_points(pixels),
                  std::min(kMostOfSmallDense, share_of(pixels, kShareOfSmall)));
}

std::size_t default_cramped_video_control_points(std::uint64_t pixels) {
  return std::max(default_dense_drawn_video_control_points(pixels),
                  std::min(kMostOfSmallCramped, share_of(pixels, kShareOfSmallCramped)));
}

std::size_t most_control_points(const Options& options, const image::Image& picture) {
  // More have no number in a space, and what is reckoned with them has to fit into integers.
  constexpr std::size_t kMost = std::numeric_limits<spline::FunctionIndex>::max();
  return options.max_control_points > 0 ? std::min(kMost, options.max_control_points)
                                        : default_control_points(picture);
}

Options preset_options(Preset preset) {
  Options options;
  switch (preset) {
    case Preset::kFast:
      options.rounds = 2;
      options.optimise.rounds = 1;
      options.optimise.steps = 2;
      options.descent_steps = 0;
      options.fine_grid = FineGrid::kNone;
      options.room_for_features = false;
      break;
    case Preset::kBalanced:
      break;
    case Preset::kFine:
      options.optimise.rounds = 4;
      options.optimise.steps = 5;
      options.descent_steps = 40;
      options.half_rows = false;
      // What is meant to be true to the picture leaves its softer edges soft.
      options.detect.max_blur = 1;
      options.drawn_blur = 2;
      break;
  }
  return options;
}

Options group_preset_options(Preset preset) {
  Options options = preset_options(preset);
  if (preset != Preset::kBalanced) return options;
  options.rounds = 2;
  options.optimise.steps = 2;
  return options;
}

Options video_options(Options picture) {
  picture.first_share = std::max(picture.first_share, 0.95);
  picture.feature_share = std::min(picture.feature_share, 0.15);
  // Small letters would have to be bent in each frame, and are truer without (docs/decisions/0033).
  if (picture.max_turning == 0) picture.max_turning = 0.15;
  // Each vertex has to be carried along; and the frames behind bend their curves anyhow.
  picture.parametrize.polyline_distance = std::max(picture.parametrize.polyline_distance, 2.0);
  picture.geometry.feature_weight = std::min(picture.geometry.feature_weight, 20.0);
  picture.geometry.joint_weight = 0;  // the frames behind bend their curves anyhow
  picture.unfold = std::min(picture.unfold, 0.85);
  picture.descend_along_curves = true;
  picture.drawn_threshold = 0;
  picture.drawn_weak_share = picture.weak_share;
  // The frames behind bend their curves to their edges, which are round there (docs/decisions/0039).
  picture.corner_detection = false;
  picture.clear_curves = picture.clear_inside = false;
  picture.fine_grid = FineGrid::kNone;
  picture.longest_edge = 0;
  picture.room_for_features = false;
  picture.drawn_distance = picture.parametrize.polyline_distance;
  // The frames behind are not fitted so: it would take a tenth of their time (docs/decisions/0038).
  picture.mixed_weight = 0;
  return picture;
}

Options drawn_video_options(Options picture) {
  picture.clear_inside = false;       // 0.1 dB worse there
  picture.room_for_features = false;  // a group has one bound
  if (picture.fine_grid == FineGrid::kAll) picture.fine_grid = FineGrid::kDrawings;
  picture.fine_smoothing = 1;
  picture.noisy_smoothing = 1.2;
  // Whether a feature is weak changes from frame to frame.
  picture.drawn_weak_share = picture.feature_share;
  return picture;
}

}  // namespace knotreel::vectorize
