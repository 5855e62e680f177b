// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace knotreel {

/// Makes the threads that oneTBB would make when they are first needed: then, it ends the process if it
/// cannot.
/// @param threads  with the calling one.
/// @throws Error{kInternal} if the system does not allow for them.
void ensure_workers(int threads);

}  // namespace knotreel
