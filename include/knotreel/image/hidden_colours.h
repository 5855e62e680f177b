// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/image/image.h"

namespace knotreel::image {

/// Gives pixels that nobody sees the colours of what is seen around them, so that alpha alone has an edge
/// where a shape ends: files mostly have black there, which would cost knots, and show as a fringe in
/// enlargements. Hidden are pixels without alpha, and those with less than 16 levels of it beside one that
/// has more, whose colours are mostly rounded away. All others and alpha stay as they are; a picture in which
/// nothing is seen becomes black. Done twice, nothing changes any more.
///
/// By a pyramid of means, from the coarse to the fine (push and pull [Gortler96]): linear time, and four
/// thirds of the picture as memory. Pictures without alpha cost nothing. All threads are used; their number
/// does not show.
Image extend_seen_colours(Image picture);

}  // namespace knotreel::image
