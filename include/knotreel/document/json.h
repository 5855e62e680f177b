// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "knotreel/base/error.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/document/sequence_info.h"

namespace knotreel::document {

/// One frame as JSON on one line, for people and for programs that check us (docs/format.md, "JSON"): knots
/// one by one, multiple ones repeated, and every basis function with I, the t-configs of its T, and its
/// control point, so that B_I = sum area(T) M(u | T + I) (paper Eq. 3) can be evaluated without knowing
/// anything else. Positions in pixels, colours 0..255. Costs some 100 bytes per t-config. Thread safe.
/// @param model  the function ids, if given, become "id"; else the indices do.
/// @throws Error{kInvalidArgument} for a model with a defect (find_defect()).
std::string frame_to_json(const FrameModel& model, const SequenceInfo& info);

}  // namespace knotreel::document
