// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/judge.h"

#include <utility>

#include "knotreel/fit/squared_errors.h"
#include "knotreel/knots/block_errors.h"
#include "vectorize/fine_grid.h"
#include "vectorize/finish.h"

namespace knotreel::vectorize {

Missed Judge::missed() {
  if (of_picture_) return missed_in_picture();
  if (!means_met()) return {.means = true, .blocks = {}};
  return samples_.has_features() && options_.mixed_weight > 0 ? missed_as_drawn() : missed_as_fitted();
}

bool Judge::means_met() const {
  return log_.round().mec <= options_.mec && log_.round().meg <= options_.meg;
}

/// By all pixels, since pairs of rows have less noise.
Missed Judge::missed_as_fitted() {
  if (!draft_.fits_all_pixels) {
    fit_all_pixels(draft_.steering->basis, samples_, options_.colour, draft_);
    log_.lap("colours");
    measure_colours(samples_, draft_, log_.round());
    if (!means_met()) return {.means = true, .blocks = {}};
  }
  if (options_.block_error == 0) return {};
  return worst_blocks(
      fit::squared_errors(draft_.surface.fit.residual, samples_.weights(), samples_.picture()),
      samples_.picture());
}

/// By what would be drawn: most blocks that are missed are beside features, and look worse than they will
/// (docs/decisions/0039). Once: blocks that are good then stay so.
Missed Judge::missed_as_drawn() {
  if (good_.empty()) {
    const Outlook then = outlook(options_, samples_, log_, draft_);
    if (then.mec > options_.mec) return {.means = true, .blocks = {}};
    if (options_.block_error == 0) return {};
    Missed missed = worst_blocks(then.squared_errors, samples_.picture());
    good_.assign(then.squared_errors.size(), 1);
    for (std::size_t i = 0; i < missed.blocks.size(); ++i) good_[i] = missed.blocks[i] == 0 ? 1 : 0;
    return missed;
  }
  std::vector<float> errors = squared_errors(samples_, draft_);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (good_[i] != 0 || samples_.weights()[i] < 1) errors[i] = 0;
  }
  return worst_blocks(std::move(errors), samples_.picture());
}

/// A fine grid has four pixels for each of the picture, and edges that are spread over some of them: only
/// what would be drawn tells of the picture.
Missed Judge::missed_in_picture() {
  Outlook then = outlook(options_, *of_picture_, log_, halved(draft_));
  if (then.mec > options_.mec || log_.round().meg > options_.meg) return {.means = true, .blocks = {}};
  if (options_.block_error == 0) return {};
  const image::Image& picture = of_picture_->picture();
  Missed missed = worst_blocks(std::move(then.squared_errors), picture);
  missed.blocks = on_fine_pixels(missed.blocks, picture.width);
  return missed;
}

Missed Judge::worst_blocks(std::vector<float> errors, const image::Image& picture) const {
  const double bound = options_.mec * options_.block_error;
  if (knots::keep_worst_blocks(errors, picture.width, picture.height, bound) == 0) return {};
  return {.means = false, .blocks = std::move(errors)};
}

}  // namespace knotreel::vectorize
