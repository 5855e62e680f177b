// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/base/error.h"

namespace knotreel {

int exit_code(ErrorKind kind) noexcept {
  switch (kind) {
    case ErrorKind::kInvalidArgument:
      return 2;
    case ErrorKind::kInput:
      return 3;
    case ErrorKind::kOutput:
      return 4;
    case ErrorKind::kInterrupted:
      return 130;
    case ErrorKind::kInternal:
      break;
  }
  return 1;
}

}  // namespace knotreel
