// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "knotreel/document/frame_model.h"
#include "knotreel/document/reader.h"
#include "knotreel/image/background.h"
#include "knotreel/image/image.h"
#include "knotreel/image/read_image.h"
#include "knotreel/image/write_image.h"
#include "knotreel/raster/render.h"
#include "knotreel/video/turn.h"

/// Pictures from documents, and from either kind of file.
namespace knotreel::cli {

/// Whether a path is to be read as a picture rather than as a document: by content, else by name.
bool is_picture(const std::filesystem::path& path);

/// Opens a document; `-` is standard input. Warns if it is cut short. @throws Error{kInput}.
document::Reader open_document(const std::filesystem::path& path);

/// The same without a warning, for those who tell of it otherwise or have done so.
document::Reader open_document_silently(const std::filesystem::path& path);

/// How players show the video that a document comes from.
Turn turn_of(const document::Reader& reader);

/// Reads one frame. @throws Error{kInvalidArgument} if there is no such frame.
document::FrameModel read_frame(document::Reader& reader, std::uint64_t frame);

/// Warns where only the first frame of several is drawn, and nobody has said so.
/// @param told  --frame was given.
void warn_of_other_frames(const std::string& path, const document::Reader& reader, bool told);

/// A picture to be made a document of. @param info  filled in if not null.
/// @throws Error{kInput} as image::read_image(), and for samples that documents have no room for.
image::Image read_source(const std::filesystem::path& path, image::ImageFileInfo* info = nullptr);

/// Renders in bands and hands them to the writer, which works while the next band is rendered. Memory: two
/// bands of about a million pixels. The bits do not depend on the number of threads.
/// @throws Error{kInterrupted} after a signal.
void stream_rendering(const raster::Renderer& renderer, const image::Background& background,
                      image::RowWriter& writer);

/// The whole rendering in memory.
image::Image render_whole(const document::FrameModel& model, const raster::RenderOptions& options);

/// A picture file, or a frame of a document at its own size, as players show it; also through a pipe.
/// @param frame  of a document; none: the first, with a warning if others come through a pipe.
image::Image load_picture(const std::filesystem::path& path, const std::optional<std::uint64_t>& frame);

}  // namespace knotreel::cli
