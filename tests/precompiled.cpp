// SPDX-License-Identifier: GPL-3.0-or-later
// Has nothing: a target needs a source to own a precompiled header.
