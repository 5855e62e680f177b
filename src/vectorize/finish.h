// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "vectorize/draft.h"

namespace knotreel::vectorize {

/// Makes the draft final: its space as documents store it, the last geometry, and the colours of all pixels
/// at the very places where the renderer will look for them. @param samples go over to these places, which
/// are given away.
Fitted finish(const Options& options, Samples& samples, RunLog& log, Draft& draft);

/// What comes out, about.
struct Outlook {
  std::vector<float> squared_errors;  ///< of the pixels; 0 for those that do not count
  double mec = 0;
};

/// As if finish() came now. Rounds are fitted where the parametrization has the pixels, which beside features
/// is up to a pixel from where they will be drawn.
/// @param samples are as before in the end.
Outlook outlook(const Options& options, Samples& samples, RunLog& log, const Draft& draft);

}  // namespace knotreel::vectorize
