// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace knotreel::cli {

/// Sets up the heap for large arrays that come and go with every frame. To be called first, by one thread;
/// without effect where the C library is not glibc.
void set_up_heap();

}  // namespace knotreel::cli
