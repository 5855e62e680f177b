// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "knotreel/image/image.h"

namespace knotreel::fit {

/// Undoes, about, what soft edges did to the pixels beside features: those next to pixels that a feature
/// crosses gain what the filter of document::FrameModel::edge_softness would take from them, p + (p - F p),
/// the first step of Van Cittert's iteration. The surface is fitted to that, and softened when it is drawn.
/// Where there is alpha, colours next to what is not opaque stay.
/// @param picture  is changed in place. @param crossed 1 for pixels that a feature crosses; they stay.
void sharpen_edges(image::Image& picture, std::span<const std::uint8_t> crossed, double softness);

}  // namespace knotreel::fit
