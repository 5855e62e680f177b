// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

/// What the extension of a file's name promises, in any case of its letters.
namespace knotreel::cli {

/// For messages: in quotes, but for `-`. @param dash  what that is.
std::string quoted(const std::string& path, const char* dash);

/// That the file is a picture of a format that image::format_of_extension() knows.
bool has_picture_name(const std::filesystem::path& path);

/// That it is a video, or a picture that moves.
bool has_clip_name(const std::filesystem::path& path);

/// "pdf" or "svg", if the file is a drawing for other programs; else "".
std::string drawing_format(const std::filesystem::path& path);

/// To be called before a document is made, which may have any name but that of something else.
/// @throws Error{kInvalidArgument} that tells which command writes what the name promises.
void check_document_name(const std::string& name);

/// Warns of a name with a number such as %04d: somebody may want a document per frame.
void warn_of_numbered_document(const std::string& name);

/// To be called before a picture or a video is drawn. @param document_command  writes a document from what
/// the caller reads. @throws Error{kInvalidArgument} that tells which command writes what the name promises,
/// if that is a document or a drawing for other programs.
void check_rendering_name(const std::string& name, const std::string& document_command);

}  // namespace knotreel::cli
