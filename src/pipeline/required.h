// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"

namespace knotreel::pipeline {

/// What a job reads from. @throws Error{kInvalidArgument} if that has been forgotten.
template <class Reader>
Reader& required(Reader* reader) {
  if (reader == nullptr) throw Error(ErrorKind::kInvalidArgument, "a job has no reader");
  return *reader;
}

}  // namespace knotreel::pipeline
