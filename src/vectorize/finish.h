#pragma once

#include "vectorize/draft.h"

namespace knotreel::vectorize {

/// Makes the draft final: its space as documents store it, the last geometry, and the colours of all pixels
/// at the very places where the renderer will look for them. @param samples go over to these places, which
/// are given away.
Fitted finish(const Options& options, Samples& samples, RunLog& log, Draft& draft);

/// Squared errors of the pixels if finish() came now, about; 0 of those that do not count. Rounds are fitted
/// where the parametrization has the pixels, which beside features is up to a pixel from where they will be
/// drawn. @param samples are as before in the end.
std::vector<float> errors_if_finished(const Options& options, Samples& samples, RunLog& log,
                                      const Draft& draft);

}  // namespace knotreel::vectorize
