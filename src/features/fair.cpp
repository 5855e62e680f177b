// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/fair.h"

#include <algorithm>

#include "features/untangle.h"
#include "knotreel/base/error.h"

namespace knotreel::features {
namespace {

/// Within one pixel of the pixel's centre per axis, and no further than `most` from where the point was.
Vec2 clamped(const ChainPoint& p, Vec2 before, double most, Vec2 q) {
  const Vec2 shift = q - before;
  if (norm(shift) > most) q = before + (most / norm(shift)) * shift;
  return {std::clamp(q.x, p.x - 0.5, p.x + 1.5), std::clamp(q.y, p.y - 0.5, p.y + 1.5)};
}

/// Mean of the neighbours of an inner point: two on either side (paper Eq. 5), one beside an end.
Vec2 mean_of_neighbours(const Chain& chain, const std::vector<Vec2>& p, std::size_t i) {
  const std::size_t n = p.size();
  if (chain.closed) {
    return 0.25 * (p[(i + n - 2) % n] + p[(i + n - 1) % n] + p[(i + 1) % n] + p[(i + 2) % n]);
  }
  if (i == 1 || i == n - 2) return 0.5 * (p[i - 1] + p[i + 1]);
  return 0.25 * (p[i - 2] + p[i - 1] + p[i + 1] + p[i + 2]);
}

/// One step of Eq. 5; back again, and a little further, for negative lambda.
void step(Chain& chain, const std::vector<Vec2>& before, double lambda, double most, std::vector<Vec2>& old) {
  old.resize(chain.points.size());
  const std::size_t fixed = chain.closed ? 0 : 1;
  for (std::size_t i = 0; i < old.size(); ++i) old[i] = chain.points[i].position;
  for (std::size_t i = fixed; i + fixed < old.size(); ++i) {
    ChainPoint& p = chain.points[i];
    p.position =
        clamped(p, before[i], most, (1 - lambda) * old[i] + lambda * mean_of_neighbours(chain, old, i));
  }
}

/// Taubin's rule for the step back: waves longer than about 20 points keep their amplitude.
double step_back(double lambda) {
  constexpr double kPassBand = 0.1;
  return -lambda / (1 - kPassBand * lambda);
}

}  // namespace

void fair_chains(FeatureChains& chains, const FairOptions& options) {
  if (!(options.lambda >= 0 && options.lambda <= 1)) {
    throw Error(ErrorKind::kInvalidArgument, "lambda of the fairing must be in 0..1");
  }
  if (options.iterations < 0) {
    throw Error(ErrorKind::kInvalidArgument, "the iterations of the fairing must not be negative");
  }
  if (!(options.max_shift > 0 && options.max_shift_of_steps > 0))
    throw Error(ErrorKind::kInvalidArgument, "the shift of the fairing must be positive");
  const Positions before = positions_of(chains);
  std::vector<Vec2> scratch;
  for (std::size_t c = 0; c < chains.chains.size(); ++c) {
    Chain& chain = chains.chains[c];
    const double most = chain.stepped ? options.max_shift_of_steps : options.max_shift;
    for (int round = 0; round < options.iterations; ++round) {
      step(chain, before[c], options.lambda, most, scratch);
      if (options.keep_size) step(chain, before[c], step_back(options.lambda), most, scratch);
    }
  }
  untangle(chains, before);
}

}  // namespace knotreel::features
