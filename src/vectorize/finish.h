#pragma once

#include "vectorize/draft.h"

namespace knotreel::vectorize {

/// Makes the draft final: its space as documents store it, the last geometry, and the colours of all pixels
/// at the very places where the renderer will look for them. @param samples go over to these places, which
/// are given away.
Fitted finish(const Options& options, Samples& samples, RunLog& log, Draft& draft);

}  // namespace knotreel::vectorize
