// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/sample_models.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <sstream>

#include "knotreel/mesh/triangulate.h"
#include "knotreel/spline/link.h"
#include "support/mesh_cases.h"

namespace knotreel::testing {

using document::FrameModel;
using mesh::KnotIndex;
using mesh::KnotKind;

namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

std::uint32_t below(Random& random, std::size_t n) {
  return static_cast<std::uint32_t>(random() % n);
}

/// Any triangulation of a polygon, also bad ones: every choice is valid at degree 2 and 3.
void random_link(Random& random, std::size_t n, std::vector<std::uint16_t>& codes) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i <= 2) continue;
    const auto code = below(random, j - i - 1);
    codes.push_back(static_cast<std::uint16_t>(code));
    open.emplace_back(i + 1 + code, j);
    open.emplace_back(i, i + 1 + code);
  }
}

}  // namespace

FrameModel random_model(mesh::KnotMesh mesh, int degree, int channels, std::uint64_t seed,
                        bool random_links) {
  Random random(seed);
  FrameModel model;
  if (random_links) {
    model.space = std::make_shared<spline::SplineSpace>(
        std::move(mesh), degree, [&](const spline::LinkPolygon& polygon, std::vector<std::uint16_t>& codes) {
          random_link(random, polygon.corners.size(), codes);
        });
  } else {
    model.space = std::make_shared<spline::SplineSpace>(std::move(mesh), degree);
  }
  model.channels = channels;
  for (std::size_t g = 0; g < model.space->geometry_count(); ++g) {
    model.displacement.push_back({uniform(random, -2, 2), uniform(random, -2, 2)});
  }
  for (std::size_t i = 0; i < model.space->function_count() * static_cast<std::size_t>(channels); ++i) {
    model.colour.push_back(uniform(random, -40, 300));
  }
  model.edge_softness = static_cast<double>(below(random, 65)) * document::kEdgeSoftnessStep;
  model.pts = static_cast<std::int64_t>(seed % 1000);
  return model;
}

mesh::KnotMesh random_mesh(int width, int height, int knots, int segments, std::uint64_t seed) {
  Random random(seed);
  for (;;) {
    MeshBuilder builder(width, height);
    const double spacing = std::sqrt(static_cast<double>(width) * height / knots);
    // Features lie in cells of their own, so that they do not cross.
    for (int s = 0; s < segments; ++s) {
      const double x = std::floor(uniform(random, 0.1, 0.8) * width / (4 * spacing)) * 4 * spacing + spacing;
      const double y = (s + 0.3) * height / std::max(segments, 1);
      const auto a = builder.vertex(x + 0.3, y + 0.4);
      const auto b = builder.vertex(x + 1.5 * spacing, y + 0.2 * spacing);
      const auto c = builder.vertex(x + 2.5 * spacing, y - 0.2 * spacing + 0.1);
      builder.segment(a, b, 2);
      builder.segment(b, c, 1);
    }
    for (double s = spacing; s < width - spacing / 2; s += spacing) {
      builder.border(s, 0);
      builder.border(s + 0.2, height);
    }
    for (double s = spacing; s < height - spacing / 2; s += spacing) {
      builder.border(0, s);
      builder.border(width, s + 0.2);
    }
    const double cell = spacing * 1.05;
    for (double y = 0; y + cell < height; y += cell) {
      for (double x = 0; x + cell < width; x += cell) {
        builder.free(x + cell * uniform(random, 0.15, 0.85), y + cell * uniform(random, 0.15, 0.85));
      }
    }
    try {
      return builder.triangulated();
    } catch (const std::exception&) {
      // Rare: a knot fell onto a feature. Draw again.
    }
  }
}

FrameModel picture_model(int width, int height, int knots, std::uint64_t seed) {
  FrameModel model = random_model(random_mesh(width, height, knots, 6, seed), 2, 3, seed);
  Random random(seed + 1);
  std::normal_distribution<double> noise(0, 1);
  for (spline::FunctionIndex f = 0; f < model.space->function_count(); ++f) {
    const Vec2 g = model.space->greville(f);
    const double light = 128 + 70 * std::sin(g.x / 37) * std::cos(g.y / 29) + 8 * noise(random);
    for (std::size_t c = 0; c < 3; ++c) {
      model.colour[3 * f + c] = light + 20 * std::sin(g.x / 61 + static_cast<double>(c)) + 2 * noise(random);
    }
  }
  for (Vec2& d : model.displacement) d = {0.1 * noise(random), 0.1 * noise(random)};
  return model;
}

FrameModel shuffled(const FrameModel& model, std::uint64_t seed) {
  Random random(seed);
  const spline::SplineSpace& space = *model.space;
  mesh::KnotMesh mesh = space.mesh();
  std::vector<KnotIndex> to(mesh.knots.size());
  std::iota(to.begin(), to.end(), 0u);
  std::shuffle(to.begin(), to.end(), random);
  for (KnotIndex k = 0; k < to.size(); ++k) mesh.knots[to[k]] = space.mesh().knots[k];
  std::vector<std::uint32_t> face_order(mesh.faces.size());
  std::iota(face_order.begin(), face_order.end(), 0u);
  std::shuffle(face_order.begin(), face_order.end(), random);
  std::vector<std::size_t> turns;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const std::size_t turn = below(random, 3);
    const mesh::Face& from = space.mesh().faces[face_order[f]];
    for (std::size_t i = 0; i < 3; ++i) mesh.faces[f][i] = to[from[(i + turn) % 3]];
    turns.push_back(turn);
  }
  for (mesh::FeatureSegment& s : mesh.segments) {
    for (KnotIndex& k : s.knots) k = to[k];
    if (below(random, 2) == 0) std::reverse(s.knots.begin(), s.knots.end());
  }
  std::shuffle(mesh.segments.begin(), mesh.segments.end(), random);

  // Corners correspond by face and place.
  const mesh::CutMesh cut = mesh::cut_open(mesh);
  std::vector<mesh::CornerIndex> from_corner(cut.corners.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      from_corner[cut.faces[f][i]] = space.cut().faces[face_order[f]][(i + turns[f]) % 3];
    }
  }
  // Triangles of level 1 are the configs of a quadratic space; that is what the order may not change.
  FrameModel result = model;
  std::vector<std::array<mesh::CornerIndex, 4>> triangles;
  for (const spline::Config& c : space.configs()) {
    std::array<mesh::CornerIndex, 3> t = c.triangle;
    std::sort(t.begin(), t.end());
    triangles.push_back({c.inner[0], t[0], t[1], t[2]});
  }
  std::sort(triangles.begin(), triangles.end());
  const auto policy = [&](const spline::LinkPolygon& polygon, std::vector<std::uint16_t>& codes) {
    const auto n = static_cast<std::uint32_t>(polygon.corners.size());
    std::vector<spline::PolygonTriangle> chosen;
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t j = i + 1; j < n; ++j) {
        for (std::uint32_t k = j + 1; k < n; ++k) {
          std::array<mesh::CornerIndex, 3> t{from_corner[polygon.corners[i]], from_corner[polygon.corners[j]],
                                             from_corner[polygon.corners[k]]};
          std::sort(t.begin(), t.end());
          const std::array<mesh::CornerIndex, 4> key{from_corner[polygon.vertex[0]], t[0], t[1], t[2]};
          if (std::binary_search(triangles.begin(), triangles.end(), key)) chosen.push_back({i, j, k});
        }
      }
    }
    spline::encode_triangulation(n, chosen, codes);
  };
  result.space = space.degree() == 2 ? std::make_shared<spline::SplineSpace>(mesh, 2, policy)
                                     : std::make_shared<spline::SplineSpace>(mesh, space.degree());

  std::vector<std::pair<std::array<mesh::CornerIndex, 3>, std::uint32_t>> names;
  for (std::uint32_t f = 0; f < space.function_count(); ++f)
    names.emplace_back(space.functions()[f].knots, f);
  std::sort(names.begin(), names.end());
  const auto channels = static_cast<std::size_t>(model.channels);
  for (std::uint32_t f = 0; f < result.space->function_count(); ++f) {
    auto knots = result.space->functions()[f].knots;
    for (mesh::CornerIndex& c : knots) {
      if (c != spline::kNoCorner) c = from_corner[c];
    }
    std::sort(knots.begin(), knots.end());
    const auto it = std::lower_bound(names.begin(), names.end(), std::pair{knots, 0u});
    const std::uint32_t old = it->second;
    std::copy_n(model.colour.begin() + static_cast<std::ptrdiff_t>(channels * old), channels,
                result.colour.begin() + static_cast<std::ptrdiff_t>(channels * f));
    result.displacement[result.space->geometry_of()[f]] = model.displacement[space.geometry_of()[old]];
  }
  return result;
}

FrameModel successor(const FrameModel& model, int swaps, std::uint64_t seed) {
  Random random(seed);
  mesh::KnotMesh mesh = model.space->mesh();
  const mesh::KnotMesh before = mesh;
  std::uint32_t next_id = 0;
  for (const mesh::Knot& k : mesh.knots) next_id = std::max(next_id, static_cast<std::uint32_t>(k.id) + 1);
  std::vector<KnotIndex> free;
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    if (mesh.knots[k].kind == KnotKind::kFree) free.push_back(k);
  }
  std::shuffle(free.begin(), free.end(), random);
  for (std::size_t i = 0; i < std::min(free.size(), static_cast<std::size_t>(swaps)); ++i) {
    // A new knot in the middle of a face in place of an old one.
    const mesh::Face& f = before.faces[below(random, before.faces.size())];
    const Vec2 centre =
        (1.0 / 3) * (before.knots[f[0]].position + before.knots[f[1]].position + before.knots[f[2]].position);
    mesh.knots[free[i]].id = mesh::KnotId{next_id++};
    mesh.knots[free[i]].position = centre;
  }
  for (std::size_t i = static_cast<std::size_t>(swaps); i < free.size(); i += 3) {
    Vec2& p = mesh.knots[free[i]].position;
    p = p + Vec2{uniform(random, -0.4, 0.4), uniform(random, -0.4, 0.4)};
  }
  std::shared_ptr<const spline::SplineSpace> space;
  if (swaps == 0) {
    if (mesh::find_defect(mesh)) mesh = before;
    const auto codes = model.space->link_codes();
    space = std::make_shared<spline::SplineSpace>(
        spline::SplineSpace::from_link_codes(mesh, model.space->degree(), codes));
  } else {
    try {
      mesh::triangulate(mesh);
    } catch (const std::exception&) {
      mesh = before;
    }
    space = std::make_shared<spline::SplineSpace>(mesh, model.space->degree());
  }
  FrameModel next = model;
  next.keyframe = false;
  ++next.frame;
  next.pts += 1 + below(random, 3);
  next.space = space;
  next.displacement.resize(space->geometry_count());
  const auto channels = static_cast<std::size_t>(model.channels);
  next.colour.resize(space->function_count() * channels, 100);
  for (double& c : next.colour) c += uniform(random, -3, 3);
  if (seed % 3 == 0)
    next.edge_softness = static_cast<double>(below(random, 65)) * document::kEdgeSoftnessStep;
  return next;
}

document::SequenceInfo info_of(const FrameModel& model) {
  document::SequenceInfo info;
  info.width = static_cast<int>(model.space->mesh().width);
  info.height = static_cast<int>(model.space->mesh().height);
  info.channels = model.channels;
  info.degree = model.space->degree();
  info.metadata = {{"title", "a test"}, {"source", ""}};
  return info;
}

std::vector<std::byte> bytes_of(const std::ostringstream& out) {
  const std::string text = out.str();
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> write_document(const std::vector<FrameModel>& frames,
                                      const document::EncodeOptions& options) {
  std::ostringstream out;
  document::Writer writer(out, info_of(frames.front()), options);
  for (const FrameModel& frame : frames) writer.append(frame);
  writer.finish();
  return bytes_of(out);
}

std::string difference(const FrameModel& a, const FrameModel& b) {
  const mesh::KnotMesh& m = a.space->mesh();
  const mesh::KnotMesh& n = b.space->mesh();
  if (m.width != n.width || m.height != n.height) return "size";
  if (m.knots.size() != n.knots.size()) return "number of knots";
  for (std::size_t k = 0; k < m.knots.size(); ++k) {
    if (!(m.knots[k].position == n.knots[k].position)) return "position of knot " + std::to_string(k);
    if (m.knots[k].kind != n.knots[k].kind) return "kind of knot " + std::to_string(k);
    if (m.knots[k].id != n.knots[k].id) return "id of knot " + std::to_string(k);
  }
  if (m.faces != n.faces) return "faces";
  if (m.segments.size() != n.segments.size()) return "number of segments";
  for (std::size_t s = 0; s < m.segments.size(); ++s) {
    if (m.segments[s].knots != n.segments[s].knots) return "segment " + std::to_string(s);
  }
  if (a.space->degree() != b.space->degree()) return "degree";
  if (!std::ranges::equal(a.space->link_codes(), b.space->link_codes())) return "link codes";
  const auto knots = [](const spline::Function& f) { return f.knots; };
  if (!std::ranges::equal(a.space->functions(), b.space->functions(), {}, knots, knots)) return "functions";
  if (!std::ranges::equal(a.space->geometry_of(), b.space->geometry_of())) return "geometry groups";
  if (a.displacement != b.displacement) return "displacements";
  if (a.channels != b.channels) return "channels";
  if (a.colour != b.colour) return "colours";
  if (a.edge_softness != b.edge_softness) return "softness of edges";
  if (a.function_ids != b.function_ids) return "function ids";
  if (a.frame != b.frame || a.pts != b.pts || a.keyframe != b.keyframe)
    return "frame number, pts or keyframe";
  return "";
}

}  // namespace knotreel::testing
