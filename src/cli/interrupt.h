// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace knotreel::cli {

/// From now on SIGINT, SIGTERM and SIGHUP only raise a flag; a second one of whichever kind ends the program
/// at once, unless it comes so soon that it is the same one told twice. Writing to a closed pipe becomes an
/// error instead of a signal. Call once, from main().
void install_signal_handlers();

/// Whether a signal has come; for work that ends in order then.
bool interrupted();

/// To be called between units of work that take no more than a moment.
/// @throws Error{kInterrupted} once a signal has come.
void check_interrupted();

}  // namespace knotreel::cli
