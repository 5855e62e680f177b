#pragma once

#include <vector>

#include "knotreel/image/image.h"

namespace knotreel::motion {

/// Shares of pixels by luma and by chroma; both sum to 1, chroma is empty for grey pictures.
struct Histogram {
  std::vector<double> luma;
  std::vector<double> chroma;
};

/// Of every second pixel of every fourth row, which is plenty. Neighbouring bins share what lies between
/// their centres, so that small changes of light remain small.
Histogram histogram_of(const image::Image& picture);

/// 0 (equal) to 1 (no bin in common): mean of the distances of luma and chroma; of luma alone if one has no
/// chroma.
double distance(const Histogram& a, const Histogram& b);

}  // namespace knotreel::motion
