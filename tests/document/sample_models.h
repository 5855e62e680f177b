// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "knotreel/document/frame_model.h"
#include "knotreel/document/sequence_info.h"
#include "knotreel/document/writer.h"
#include "knotreel/mesh/knot_mesh.h"

/// Frames and documents for the tests of the document module. Deterministic.
namespace knotreel::testing {

/// Random control points over a mesh; links other than the default ones if random_links.
document::FrameModel random_model(mesh::KnotMesh mesh, int degree, int channels, std::uint64_t seed,
                                  bool random_links = false);

/// A mesh of random knots with a few features, about `knots` of them.
mesh::KnotMesh random_mesh(int width, int height, int knots, int segments, std::uint64_t seed);

/// Smooth colours with some noise and small displacements, much as a fit to a photograph gives them.
document::FrameModel picture_model(int width, int height, int knots, std::uint64_t seed);

/// The same knots, faces and functions in another order, with the same control points.
document::FrameModel shuffled(const document::FrameModel& model, std::uint64_t seed);

/// The next frame of a sequence: some knots move, `swaps` are removed and as many inserted, colours drift;
/// the softness of edges changes if the seed is a multiple of 3.
document::FrameModel successor(const document::FrameModel& model, int swaps, std::uint64_t seed);

document::SequenceInfo info_of(const document::FrameModel& model);

/// What was written.
std::vector<std::byte> bytes_of(const std::ostringstream& out);

/// A finished document in memory.
std::vector<std::byte> write_document(const std::vector<document::FrameModel>& frames,
                                      const document::EncodeOptions& options = {});

/// Empty if the models are the same bit by bit, else the first field that differs.
std::string difference(const document::FrameModel& a, const document::FrameModel& b);

}  // namespace knotreel::testing
