// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace knotreel::testing {

/// Makes all checksums of a damaged document agree with its bytes again, as far as its chunks can be
/// followed.
void reseal(std::vector<std::byte>& document);

}  // namespace knotreel::testing
