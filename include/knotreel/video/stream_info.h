// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// Video in and out. Frames are Images; times are whole numbers of ticks of the stream's time base.
namespace knotreel::video {

/// num / den; den is above 0. As a rate or an aspect, 0/1 means unknown.
struct Rational {
  std::int64_t num = 0;
  std::int64_t den = 1;

  /// Whether it is above 0.
  bool known() const { return num > 0 && den > 0; }
  double value() const { return double(num) / double(den); }
  friend bool operator==(const Rational&, const Rational&) = default;
};

/// What a stream says of its colours, in the numbers of ITU-T H.273; 2 (0 for range and chroma_location) is
/// "not told", and what is not told in a source stays untold in an output.
struct ColourTags {
  int range = 0;            ///< 1 limited ("TV"), 2 full
  int matrix = 2;           ///< from RGB to luma and chroma: 1 BT.709, 5 and 6 BT.601, 9 BT.2020
  int primaries = 2;        ///< kept, never applied
  int transfer = 2;         ///< kept, never applied
  int chroma_location = 0;  ///< 1 left, 2 centre, 3 top left, 4 top, 5 bottom left, 6 bottom

  friend bool operator==(const ColourTags&, const ColourTags&) = default;
};

/// libav's names of what is told, such as "tv" and "bt709"; empty where nothing is.
struct ColourNames {
  std::string range, matrix, primaries, transfer, chroma_location;
};
/// Numbers that libav does not know have no name.
ColourNames names_of(const ColourTags& tags);

/// Whether frames hold the lines of two moments in turns, and which come first; kNone also if it is not told.
enum class Fields : std::uint8_t { kNone, kTopFirst, kBottomFirst };

/// What is known of a video, and what a writer has to know of the frames that it will get.
struct StreamInfo {
  int width = 0;              ///< pixels of the frames handed out, before any rotation
  int height = 0;             ///< see width
  int channels = 3;           ///< of frames handed out: 1 grey, 2 grey + alpha, 3 RGB, 4 RGBA
  int depth = 8;              ///< bits per component in the source
  std::string pixel_format;   ///< libav's name, such as "yuv420p10le"; empty: not known
  std::string codec;          ///< libav's name, such as "h264"; pictures: that of their format
  std::string container;      ///< libav's name(s), such as "mov,mp4,m4a,3gp,3g2,mj2"
  Rational time_base{1, 25};  ///< seconds per tick
  Rational frame_rate;        ///< frames per second, the average if it varies
  Rational sample_aspect;     ///< width of a pixel to its height
  ColourTags colour;
  Fields fields = Fields::kNone;          ///< of the source, before it is deinterlaced
  std::vector<std::byte> display_matrix;  ///< 3 x 3, as libav keeps it; empty if none. Kept, not applied
  std::int64_t start = 0;    ///< ticks that a writer takes away: the clock of MPEG TS and PS starts anywhere
  std::uint64_t frames = 0;  ///< an estimate; 0 if unknown
  double seconds = 0;        ///< an estimate; 0 if unknown
  std::int64_t end = 0;      ///< ticks at which the last frame ends, as the container tells; 0 if it does not
  bool timestamps = true;    ///< false: the source has none, and they are made from the frame rate
  bool still = false;        ///< a single picture
};

/// By how much a player turns the pictures clockwise, -180 to 180 degrees; mirrored ones are mirrored left to
/// right before that.
double rotation_degrees(const StreamInfo& info);

/// Whether a player shows the pictures mirrored.
bool is_mirrored(const StreamInfo& info);

/// The shape of pixels that shows a stream's pictures as wide as they are, brought to another size. Square
/// ones stay so: who asks for another shape of pictures wants to see it. Nor do they change for what a size
/// is rounded.
Rational sample_aspect_at(const StreamInfo& stream, int width, int height);

/// Any of the streams of a file.
struct StreamEntry {
  int index = 0;
  std::string kind;      ///< "video", "audio", "subtitle", ...
  std::string codec;     ///< libav's name
  std::string language;  ///< such as "eng"; empty if it is not told
};

}  // namespace knotreel::video
