// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "knotreel/video/stream_info.h"

/// What `knotreel info` tells, as JSON and as text made from it.
namespace knotreel::cli {

using Facts = nlohmann::ordered_json;

/// Reads every frame, so a document of which this tells is sound. @throws Error{kInput}.
Facts document_facts(const std::string& path);
std::string document_text(const std::string& path, const Facts& facts);

/// Opens it and decodes its first frame. @throws Error{kInput}.
Facts video_facts(const std::string& path);
std::string video_text(const std::string& path, const Facts& facts);

/// "grey", "RGB" and so on.
std::string channels_name(int channels);

/// How players show the pictures of a video, or of a document made of one: a line; empty if as they are.
/// @param facts  with members rotation and mirrored.
std::string turn_text(const Facts& facts);

/// [num, den], or null if it is not known.
Facts rational_facts(video::Rational value);
/// "25", "29.97 (30000/1001)"; "unknown".
std::string rate_text(const Facts& rational);

}  // namespace knotreel::cli
