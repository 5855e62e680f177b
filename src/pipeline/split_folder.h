// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

/// The folder of documents of one frame each.
namespace knotreel::pipeline {

/// Makes it, unless it is there. @param folder  empty: there is none. @throws Error{kOutput}.
void make_split_folder(const std::string& folder);

/// "frame_000001.tcb" in it for the first frame, whose index is 0.
std::string single_path(const std::string& folder, std::uint64_t index);

}  // namespace knotreel::pipeline
