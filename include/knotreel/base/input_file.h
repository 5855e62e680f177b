// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "knotreel/base/error.h"

namespace knotreel {

/// What read_whole() calls ten times a second while a pipe has nothing to give; it may throw to give up. None
/// at first. Set it before any reading.
void set_check_while_waiting(void (*check)());

/// Calls it, for those who work for long before there is anything to show.
void check_while_working();

/// Reads at most `count` bytes from the start of a file; fewer if it is shorter. Not for `-`.
/// @throws Error{kInput} with the system's reason.
std::vector<std::byte> read_start(const std::filesystem::path& path, std::size_t count);

/// Reads a whole file, or standard input for `-`.
/// @param max_bytes  larger inputs are refused, after at most that many bytes (endless pipes and devices).
/// @param kind       what the file should be, for the message, such as "image"; may be empty.
/// @throws Error{kInput}: `cannot read image 'x': <why>`.
std::vector<std::byte> read_whole(const std::filesystem::path& path, std::uint64_t max_bytes,
                                  const std::string& kind = {});

/// The start of such messages: "cannot read image 'x': " or "cannot read image from standard input: ".
std::string cannot_read(const std::filesystem::path& path, const std::string& kind = {});

}  // namespace knotreel
