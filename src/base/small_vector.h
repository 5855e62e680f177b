// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/container/small_vector.hpp>
#include <cstddef>

namespace knotreel {

/// A vector that needs no memory of its own for up to N elements: for the many short lists that are made and
/// dropped again for each knot or link of each frame.
template <class T, std::size_t N>
using SmallVector = boost::container::small_vector<T, N>;

}  // namespace knotreel
