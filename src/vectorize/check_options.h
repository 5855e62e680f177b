// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/vectorize/options.h"

namespace knotreel::vectorize {

/// @throws Error{kInvalidArgument} telling the first that is out of range.
void check_options(const Options& options);

}  // namespace knotreel::vectorize
