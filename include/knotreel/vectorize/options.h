// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "knotreel/document/writer.h"
#include "knotreel/features/colour_correction.h"
#include "knotreel/features/corners.h"
#include "knotreel/features/detect.h"
#include "knotreel/features/fair.h"
#include "knotreel/fit/colour_fit.h"
#include "knotreel/fit/geometry_fit.h"
#include "knotreel/knots/optimise.h"
#include "knotreel/param/parametrization.h"

namespace knotreel::vectorize {

/// Trade of time for quality; sets the effort of Options.
enum class Preset : std::uint8_t {
  kFast,      ///< fewer sweeps over the knot mesh, no descent on the true residual
  kBalanced,  ///< the default
  kFine,      ///< until more effort brings little
};

/// Of larger pictures none has a fine grid: twice the pixels each way take 1.4 KB for each of the picture's.
inline constexpr std::uint64_t kMostFineGridPixels = 1'250'000;

/// Which pictures of up to kMostFineGridPixels have features found, and knots placed, on pixels of half the
/// size, where strokes of one or two pixels have two sides (docs/decisions/0044).
enum class FineGrid : std::uint8_t {
  kNone,
  kDrawings,  ///< features::is_drawing()
  kAll,
};

/// All settings of a picture's way to a vector model. Lengths are pixels, errors levels of 0..255.
struct Options {
  int degree = 2;  ///< of the splines, 1 to 3
  double mec = 2;  ///< rounds stop when the mean colour error per pixel is below; >= 0
  /// Times mec: and the root mean square error of each block of 16x16 pixels is, so that nothing is left out
  /// where the rest is easy (docs/decisions/0032); 0: blocks do not count.
  double block_error = 4;
  double meg = 1;                      ///< and the mean error of the feature curves too, pixels; >= 0
  int rounds = 3;                      ///< of fitting, each but the first after inserting knots; 1 or more
  std::size_t max_control_points = 0;  ///< upper bound; 0: default_control_points()
  /// Whether the bound by default grows to default_control_points_with_features() where it has no room for
  /// the features, or where a drawing cannot be read with it (docs/decisions/0052).
  bool room_for_features = true;
  /// Share of these that the first round may use, above 0, up to 1, if there are others: what is left, and
  /// what is idle, goes where that fit was worst.
  double first_share = 0.8;
  /// For drawings (features::is_drawing()) with features: longer edges of the mesh are split before anything
  /// else asks for knots (docs/decisions/0055), with up to a quarter of those that the bound leaves. Pixels,
  /// >= 0; 0: none.
  double longest_edge = 64;
  std::uint64_t seed = 1;  ///< kept in reports; the method draws no random numbers

  bool features = true;  ///< whether to look for features at all
  /// Share of the control points that features may use up, 0 to 1; if they would need more, those of least
  /// contrast for what they cost are left out, down to 0.3 at most. It is 0.6 at least where the first knots
  /// need but two fifths of all.
  double feature_share = 0.6;
  /// Share of the control points above which weak features among them go, 0 to 1: soft edges, or those beside
  /// others, of little contrast.
  double weak_share = 0.1;
  /// For drawings (features::is_drawing()), in place of weak_share, if that is less: their areas touch, and
  /// what is between them shows (docs/decisions/0039).
  double drawn_weak_share = 0.2;
  /// Radians per pixel in the mean, >= 0: features that turn more, such as letters of a few pixels, are left
  /// to the smooth surface. 0: none are.
  double max_turning = 0;
  bool fairing = true;
  bool corner_detection = true;  ///< curves get sharp corners where two straight sides meet
  bool colour_correction = true;
  bool picture_links = true;  ///< link triangulations chosen by the picture
  features::DetectOptions detect{
      .edge_threshold = 8, .anchor_threshold = 16, .min_length = 10, .min_weight = 600, .max_blur = 2};
  /// For drawings (features::is_drawing()). In place of detect.max_blur, if that is a limit (not 0) and
  /// smaller: the smooth surface does not replace their edges.
  double drawn_blur = 0;
  /// In place of detect.edge_threshold, if that is larger, with the anchor threshold in proportion: there is
  /// no noise, so that faint edges are edges, too. 0: off.
  double drawn_threshold = 1;
  features::FairOptions fair{};
  features::CornerOptions corners{};
  /// A fifth of the paper's: most edges of photographs are blurred by the lens, and what is made sharper than
  /// the picture costs PSNR (docs/decisions/0012, 0033).
  features::CorrectionOptions correction{.strength = 0.2};
  /// A third of the paper's three pixels: the geometry part has less to bend, and folds less often.
  param::ParametrizeOptions parametrize{.polyline_distance = 1};
  /// For drawings (features::is_drawing()), in place of parametrize.polyline_distance, if that is larger, as
  /// long as features then use up no more than their share: corners between vertices are lost. > 0.
  double drawn_distance = 0.7;
  /// One to three simple knots per feature segment, about this far apart, > 0.
  double segment_knot_spacing = 12;
  /// Curves have room: segments of less than three pixels have no knots inside, and edges of the mesh leave
  /// the ends of others beside the curve, not along it (docs/decisions/0043).
  bool clear_curves = true;
  bool clear_inside = true;  ///< with clear_curves, at knots inside segments, too
  /// Takes two to three times the time and memory. Lengths and thresholds of other options
  /// stay those of the picture.
  FineGrid fine_grid = FineGrid::kDrawings;
  /// Times detect.smoothing, on a fine grid, in its pixels; > 0. Less than 2, which is the same in pixels of
  /// the picture: that is what fine pixels are for.
  double fine_smoothing = 0.8;
  /// The same of drawings that are not clean (features::is_clean()), which have no drawn_threshold then. 0:
  /// all count as clean.
  double noisy_smoothing = 0;

  knots::OptimiseOptions optimise{.rounds = 1, .steps = 4};
  fit::ColourFitOptions colour{.precision = fit::Precision::kSingle};
  fit::GeometryFitOptions geometry{};
  /// Of pixels that features cross, when the last colours are fitted to what is drawn of them, >= 0; 0: they
  /// are not (docs/decisions/0038).
  double mixed_weight = 1;
  double unfold = 0.95;   ///< factor of displacements at folds, as fit::unfold_geometry() takes it
  bool half_rows = true;  ///< rounds and descent look at pairs of rows: about half the time, -0.1 dB
  int descent_steps = 2;  ///< on the true residual; >= 0; 0: none
  bool descend_along_curves = false;  ///< knots on features move, too: fit::DescentOptions::along_curves

  /// The last fit is to knots and displacements as keyframes of documents have them; ranges as there.
  int knot_bits = document::EncodeOptions{}.knot_bits;
  double displacement_step = document::EncodeOptions{}.displacement_step;  ///< pixels
};

/// As many as usual and, for a photograph or film, what letters written over it ask for besides: one for each
/// of features::caption_pixels() (docs/decisions/0051).
/// @param most in all, if that is more than usual.
std::size_t with_captions(const image::Image& picture, std::size_t usual, std::size_t most);

/// 2.75 % of the pixels: for photographs about 0.75 bytes per pixel by raw_accounting_bytes(). Of icons and
/// other small pictures 20 %, up to 3000, but at least 256: each of their pixels tells more
/// (docs/decisions/0037). Of drawings (features::is_drawing()) 10 %, and 2 % more for each percent of the
/// pixels that is not flat (features::flat_share()) beyond a quarter, up to 200,000: most need far fewer, and
/// where there is small text nothing else keeps it legible (docs/decisions/0036, 0039). Of others up to 10 %
/// with_captions().
std::size_t default_control_points(const image::Image& picture);

/// Where that has no room for the features (docs/decisions/0050): 40 % of the pixels of a drawing, 10 % of
/// others, up to 200,000, or as many as by default if that is more.
std::size_t default_control_points_with_features(const image::Image& picture);

/// 2 % of the pixels, but at least 256, of a frame of a video: it has less to give than a photograph, since
/// its colours are coarser, and the frame before tells most of it. Of small ones 20 %, up to 1500.
std::size_t default_video_control_points(std::uint64_t pixels);

/// The same of frames that are drawn (docs/decisions/0040), but up to 3000 of small ones: a drawing has as
/// many outlines in any size.
std::size_t default_drawn_video_control_points(std::uint64_t pixels);

/// Of frames of drawings that are made as film but ask for more, such as pages of small text: 10 % of the
/// pixels, up to 200,000, as a drawing that is a picture on its own may have.
std::size_t default_dense_video_control_points(std::uint64_t pixels);

/// The same of frames that are drawn, but 20 % of small ones, up to 50,000: most ask for far fewer, and those
/// that fill their bound are made anew again and again (docs/decisions/0049).
std::size_t default_dense_drawn_video_control_points(std::uint64_t pixels);

/// Of drawn frames that fill these and would be illegible else, such as spreadsheets: 30 % of small ones, up
/// to 75,000 (docs/decisions/0050).
std::size_t default_cramped_video_control_points(std::uint64_t pixels);

/// Those that a model may have at most: what the options say, up to 2^32 - 1, or as many as by default.
std::size_t most_control_points(const Options& options, const image::Image& picture);

/// The effort of a preset, all else as by default.
Options preset_options(Preset preset);

/// The effort of a preset for frames of a video that others are made from. Those go on mending, so that two
/// rounds do where a picture on its own has three: the video is as good, and its first frame there sooner
/// (docs/decisions/0030).
Options group_preset_options(Preset preset);

/// Those of a picture made fit for the frames of a video: with fewer control points per pixel and edges
/// blurred by lossy codecs, all but the strongest features cost more than they bring (docs/decisions/0017).
/// The program takes these, with default_video_control_points() as the bound if none is given.
Options video_options(Options picture);

/// Those of a picture made fit for drawn frames of a video, whose features are found anew in each
/// (docs/decisions/0040): all features stay if they can, and codecs leave traces where nothing was drawn.
Options drawn_video_options(Options picture);

}  // namespace knotreel::vectorize
