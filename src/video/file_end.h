// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace knotreel::video {

/// kUnknown also where a file that is cut short may look like that.
enum class FileEnd : std::uint8_t { kUnknown, kMissing, kThere };

/// What the format of a file tells of its end; most demuxers of libav take a file that is cut short for one
/// that ends there. Knows Matroska and AVI (the sizes of their elements), NUT (its index), Ogg (its last
/// page), GIF, APNG and Motion JPEG (markers at the end), ASF (the size told), MPEG transport streams (whole
/// packets).
/// @param format  name of the demuxer
/// @return kUnknown if the format tells of no end, or the input is no regular file.
FileEnd end_of_file(const std::string& path, const std::string& format);

/// The same of a pipe that has been read to its end; knows Matroska. @param start  its first 256 bytes.
/// @param size  of what has been read.
FileEnd end_of_pipe(std::string_view start, std::uint64_t size, const std::string& format);

}  // namespace knotreel::video
