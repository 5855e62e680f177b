#pragma once

#include <string>

namespace knotreel::video {

/// Whether a file is cut short by what its format tells of its own end; most demuxers of libav take a file
/// that is cut short for one that ends there. Knows Matroska (the size of its segment), Ogg (its last page),
/// GIF, APNG and Motion JPEG (markers at the end), MPEG transport streams (whole packets).
/// @param format  name of the demuxer
/// @return false if the format tells of no end, or the input is no regular file.
bool lacks_its_end(const std::string& path, const std::string& format);

}  // namespace knotreel::video
