#pragma once

#include <span>
#include <vector>

namespace knotreel::fit {

/// Of a residual, summed over the channels of each pixel; 0 for pixels that do not count, as in MEC and PSNR.
/// @param weights by pixel; those below 1 do not count. Empty: all count.
/// Safe to call from several threads; same bits for any number of threads.
std::vector<float> squared_errors(std::span<const float> residual, std::span<const float> weights,
                                  int channel_count);

}  // namespace knotreel::fit
