// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/document/writer.h"
#include "knotreel/image/image.h"
#include "knotreel/knots/idle_knots.h"
#include "knotreel/spline/basis.h"
#include "knotreel/spline/pixel_surface.h"
#include "knotreel/track/birth_options.h"
#include "knotreel/track/carry_mesh.h"
#include "knotreel/track/cold_frame.h"
#include "knotreel/track/drawn_curves.h"
#include "knotreel/track/motion.h"
#include "knotreel/vectorize/options.h"

namespace knotreel::track {

struct TrackOptions {
  /// vectorize::drawn_video_options(), for drawings (features::is_drawing()) that are better with them; null:
  /// none are looked at so.
  std::shared_ptr<const vectorize::Options> drawn = nullptr;
  /// The same with a larger bound on control points, for drawings that have no room in that of `drawn` and
  /// are worth it. Such a group has as many as its first frame asks for, and some more. Null: none are.
  std::shared_ptr<const vectorize::Options> dense = nullptr;
  /// As the film options, with a larger bound, for drawings whose features have no room in any other and that
  /// would be illegible: pages of small text. Groups as those of `dense`. Film may have up to as many, too,
  /// as far as captions ask for them (vectorize::with_captions()). Null: none are.
  std::shared_ptr<const vectorize::Options> dense_film = nullptr;
  /// As `drawn`, with a bound of at least that of `dense`, for drawings that would be illegible even by
  /// `dense_film`: if all of their features have room in it, they may fill it. Null: none are.
  std::shared_ptr<const vectorize::Options> cramped = nullptr;
  bool warm_start = true;  ///< false: every frame is made from its picture alone
  /// Share of what the frame before missed that this one is not asked to mend, along motion, 0 to 1: keeps
  /// noise from flickering. Where nothing moves it counts twice.
  double temporal_weight = 0.5;
  int keyframe_interval = 250;   ///< most frames of a group, 1 or more
  double scene_threshold = 0.4;  ///< as motion::CutOptions::threshold
  /// While the MEC is above the one asked for, a cold frame is considered when the fit is this many dB worse
  /// than when that was done last, or at the start of the group ...
  double drift = 1.8;
  int look_interval = 16;     ///< ... and when so many frames have gone by, 1 or more
  double restart_gain = 1.3;  ///< it is made if it promises to be better by so many dB, and kept if it is
  double grow_above = 1.1;    ///< times the MEC asked for: frames above it are followed by ones with ...
  double growth = 0.05;       ///< ... this share more of control points, as long as the bound leaves room
  /// Every so many frames, 1 or more, knots settle, and idle and lost ones come back elsewhere; in between
  /// they only follow the motion.
  int rework_interval = 2;
  bool settle = true;  ///< whether knots go on descending on the true residual, a step each time
  /// In so many steps, 0 or more, but no more than the cold frame's knots::OptimiseOptions has, new knots are
  /// moved to where the picture wants them ...
  int inserted_steps = 4;
  double much_new = 0.08;  ///< ... with their neighbours, if they are more than this share of all
  /// Frames, 1 or more, between looks whether the feature curves miss edges; after a frame without one that
  /// was worse by repair_below, there is one in every frame for a while.
  int bend_interval = 2;
  double curve_error = 0.15;  ///< root mean square miss of the feature curves that they are bent for, pixels
  double reluctance = 0.6;    ///< of control points to change their colours (fit::ColourFitOptions) ...
  double reluctance_error = 2;  ///< ... and less where the frame before was missed by less than this, levels
  CarryOptions carry{};
  knots::SwapOptions swap{};
  /// When a frame is worse than the one before by this, knots are put where the error is at once, and it is
  /// fitted again; dB ...
  double repair_below = 0.4;
  /// ... times 1 + repair_patience s, where s is the share of the frames of late that were: what falls all
  /// the time is not worth to be fitted twice all the time. 0 or more.
  double repair_patience = 5;
  int most_repairs = 1;  ///< of one frame
  /// When a frame that is not repaired is worse by this, knots are put where its error is for the next; dB.
  double mend_below = 0.3;
  /// When a frame can be told to become so much worse, dB, idle knots are put elsewhere before it is fitted.
  double swap_above = 1;
  int birth_interval = 8;  ///< frames between looks for features that the model lacks; 0: none
  BirthOptions birth{};
  /// Warm frames are fitted to their knots as documents have them, on a grid of 2^-knot_bits px.
  int knot_bits = document::EncodeOptions{}.delta_knot_bits;
  /// Likewise their displacements, to multiples of this, pixels; more than 0.
  double displacement_step = document::EncodeOptions{}.displacement_step;
  /// What is measured, drawn and gone on from has the colours of control points as documents have them, too:
  /// in steps of this in keyframes, levels, more than 0 ...
  double colour_step = document::EncodeOptions{}.colour_step;
  /// ... and of so many times that in other frames, more than 0: a third less where the PSNR is above 38.5
  /// dB, a third more where it is below 26.
  double delta_coarseness = document::EncodeOptions{}.delta_coarseness;
  knots::SwapOptions urgent_swap{.ratio = 10, .share = 0.08};
};

/// Why a frame is as it is.
enum class Start : std::uint8_t {
  kFirst,     ///< the first frame
  kCut,       ///< cold: the scene changes
  kInterval,  ///< cold: the group has as many frames as it may
  kDrift,     ///< cold: the carried model had become too bad
  kWarm,      ///< from the frame before
};

/// "first", "cut", "interval", "drift" or "warm".
const char* to_string(Start start);

/// What was done to make the mesh of a warm frame from that of the frame before.
struct MeshChanges {
  CarryReport carry;
  std::size_t swapped = 0;        ///< knots taken away where they were idle
  std::size_t inserted = 0;       ///< knots for those that were lost and swapped
  std::size_t features_born = 0;  ///< feature polylines that were added
  int repairs = 0;                ///< further fits, because the frame was worse than the one before
};

struct FrameReport {
  Start start = Start::kFirst;
  std::size_t knots = 0;
  std::size_t control_points = 0;
  double mec = 0;       ///< of the fit, levels, as in vectorize::RoundReport
  double psnr = 0;      ///< of the fit, dB
  double survival = 0;  ///< share of the knots of the frame before that are in this one, 0 to 1
  /// Of a first frame that is a drawing, but was not drawn for want of control points: what a still like it
  /// has, if that is more. Else 0.
  std::size_t wanted_control_points = 0;
  bool features_dropped = false;  ///< as vectorize::Report, of a frame made from its picture alone
  MeshChanges changes;
  std::vector<std::pair<std::string, double>> milliseconds;  ///< per stage, in order
};

/// What of a frame may be made before it is its turn. The result is the same with and without; only the time
/// is not.
struct MadeAhead {
  /// Of make_cold_frame() for its picture and the same options: taken if the frame starts a group, left alone
  /// otherwise.
  std::shared_ptr<ColdFrame> cold = nullptr;
  /// Of find_drawn_curves() for its picture and TrackOptions::drawn: taken if the frame is drawn like that.
  std::shared_ptr<const DrawnCurves> curves = nullptr;
};

/// Makes the vector model of each picture of a video from that of the picture before (docs/algorithm.md,
/// "video"): knots and features follow the motion, where nothing moves nothing changes, and only the colours
/// are fitted again. A picture that is repeated has the model that it had, if that is good. Frames come in
/// order; not safe to use from several threads. The result does not depend on the number of threads.
class Tracker {
 public:
  /// @param first why the first frame starts a group: a tracker may begin at a cut, since nothing of what was
  ///              before has any influence from there on.
  /// @throws Error{kInvalidArgument} for track options out of range; for others next() does.
  Tracker(const vectorize::Options& cold, const TrackOptions& options, Start first = Start::kFirst);
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  /// @param picture of the same size and channels as those before.
  /// @param motion  from the picture before; null for the first frame and after a gap: a cold start.
  /// @return the model, keyframe if it does not depend on the one before; frame and pts are left to the
  /// caller.
  /// @throws Error{kInvalidArgument} as vectorize_picture(), and if sizes differ.
  document::FrameModel next(const image::Image& picture, const Motion* motion, FrameReport* report = nullptr,
                            MadeAhead ahead = {});

  /// Whether the next frame starts a group whatever comes of it. @param motion as for next().
  bool starts_group(const Motion* motion) const;

  /// How the last frame was drawn: the next one will most likely want find_drawn_curves() like that, if at
  /// all. May be asked by any thread at any time.
  Drawing drawing() const;

  /// For find_drawn_curves(). May be called while next() is at work.
  std::shared_ptr<KnownDrawings> known_drawings() const;

  /// The last model at its pixels, for whoever draws it; only those that features cross look different.
  std::shared_ptr<const spline::PixelSurface> surface() const;

  /// By tile of 8x8 pixels (spline::PixelTiles): 0 where the last model looks, but for rounding, as the one
  /// before does at its own size, at features too; none: it may be another one everywhere.
  std::vector<std::uint8_t> changed_tiles() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace knotreel::track
