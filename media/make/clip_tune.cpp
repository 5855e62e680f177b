// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "clip.h"

namespace knotreel::media {
namespace {

constexpr double kTau = 2 * std::numbers::pi;

/// A plucked tone, `t` seconds after its start.
double tone(double half_tones_above_a, double t) {
  if (t < 0) return 0;
  const double turn = kTau * 440 * std::pow(2, half_tones_above_a / 12) * t;
  const double swell = 1 - std::exp(-200 * t);
  return swell * std::exp(-4 * t) * (std::sin(turn) + 0.35 * std::sin(2 * turn) + 0.1 * std::sin(3 * turn));
}

}  // namespace

std::vector<float> clip_tune() {
  constexpr double kBeat = 0.25;
  // Half tones above a': sixteen beats; the second half, after the cut, goes up.
  constexpr int kMelody[] = {-9, -5, -2, 3, -2, -5, -9, -5, -7, -4, 0, 5, 0, 3, 5, 7};
  std::vector<float> samples(std::size_t(kClipFrames) * kSoundRate / kClipRate);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = double(i) / kSoundRate;
    double sum = 0;
    for (int beat = 0; beat < 16; ++beat) {
      sum += tone(kMelody[beat], t - kBeat * beat);
      if (beat % 4 == 0) sum += 0.8 * tone(kMelody[beat] - 12, t - kBeat * beat);
    }
    const double end = double(kClipFrames) / kClipRate;
    samples[i] = float(0.25 * sum * std::min(1.0, (end - t) / 0.1));
  }
  return samples;
}

}  // namespace knotreel::media
