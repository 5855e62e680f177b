// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/mesh_cases.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/mesh/triangulate.h"

namespace knotreel::testing {

using mesh::KnotIndex;
using mesh::KnotKind;
using mesh::KnotMesh;

namespace {

const char* kind_name(KnotKind kind) {
  switch (kind) {
    case KnotKind::kFree:
      return "free";
    case KnotKind::kBorder:
      return "border";
    case KnotKind::kSegment:
      return "segment";
    case KnotKind::kVertex:
      break;
  }
  return "vertex";
}

KnotKind kind_of(const std::string& name) {
  for (const KnotKind k : {KnotKind::kFree, KnotKind::kBorder, KnotKind::kSegment, KnotKind::kVertex}) {
    if (name == kind_name(k)) return k;
  }
  throw std::runtime_error("mesh corpus: unknown kind " + name);
}

/// The mesh with coordinates mapped; x and y may trade places.
KnotMesh transformed(const KnotMesh& in, bool swap, bool mirror) {
  KnotMesh out;
  out.width = swap ? in.height : in.width;
  out.height = swap ? in.width : in.height;
  out.segments = in.segments;
  for (mesh::Knot k : in.knots) {
    if (mirror) k.position.x = in.width - k.position.x;
    if (swap) std::swap(k.position.x, k.position.y);
    out.knots.push_back(k);
  }
  mesh::triangulate(out);
  return out;
}

std::vector<MeshCase> read_corpus(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot open " + path);
  std::vector<MeshCase> cases;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "case") {
      cases.emplace_back();
      words >> cases.back().name >> cases.back().mesh.width >> cases.back().mesh.height;
    } else if (word == "knot") {
      mesh::Knot knot;
      std::string kind;
      words >> kind >> knot.position.x >> knot.position.y;
      knot.kind = kind_of(kind);
      knot.id = mesh::KnotId{static_cast<std::uint32_t>(cases.back().mesh.knots.size())};
      cases.back().mesh.knots.push_back(knot);
    } else if (word == "segment") {
      mesh::FeatureSegment segment;
      for (KnotIndex k; words >> k;) segment.knots.push_back(k);
      cases.back().mesh.segments.push_back(segment);
    }
  }
  for (MeshCase& c : cases) {
    // Knots inside segments are given roughly; they belong exactly on the line.
    for (const auto& s : c.mesh.segments) {
      const Vec2 a = c.mesh.knots[s.knots.front()].position;
      const Vec2 d = c.mesh.knots[s.knots.back()].position - a;
      for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
        Vec2& p = c.mesh.knots[s.knots[i]].position;
        p = a + (dot(p - a, d) / dot(d, d)) * d;
      }
    }
    mesh::triangulate(c.mesh);
  }
  return cases;
}

class RandomMesh {
 public:
  explicit RandomMesh(std::uint64_t seed) : random_(seed) {}

  KnotMesh make() {
    const double w = std::round(uniform(40, 200));
    const double h = std::round(uniform(40, 200));
    MeshBuilder b(w, h);
    width_ = w;
    height_ = h;
    const int features = count(0, 4);
    for (int i = 0; i < features; ++i) add_feature(b);
    const int border = count(0, 8);
    for (int i = 0; i < border; ++i) {
      switch (count(0, 3)) {
        case 0:
          b.border(uniform(0, w), 0);
          break;
        case 1:
          b.border(uniform(0, w), h);
          break;
        case 2:
          b.border(0, uniform(0, h));
          break;
        default:
          b.border(w, uniform(0, h));
      }
    }
    const int free = count(5, 60);
    const bool on_grid = count(0, 3) == 0;
    for (int i = 0; i < free; ++i) {
      const Vec2 p = point();
      // Every fourth mesh has its knots on a coarse grid: many are collinear by accident.
      b.free(on_grid ? std::round(p.x / 8) * 8 : p.x, on_grid ? std::round(p.y / 8) * 8 : p.y);
    }
    return b.triangulated();
  }

 private:
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
  int count(int a, int b) { return std::uniform_int_distribution<int>(a, b)(random_); }
  Vec2 point() { return {uniform(1, width_ - 1), uniform(1, height_ - 1)}; }

  void add_feature(MeshBuilder& b) {
    const Vec2 c = point();
    switch (count(0, 4)) {
      case 0: {  // open polyline with bends
        KnotIndex last = b.vertex(c.x, c.y);
        const int n = count(1, 3);
        for (int i = 0; i < n; ++i) {
          const Vec2 p = point();
          const KnotIndex next = b.vertex(p.x, p.y);
          b.segment(last, next, count(1, 3));
          last = next;
        }
        break;
      }
      case 1: {  // junction of three to five branches
        const KnotIndex centre = b.vertex(c.x, c.y);
        const int n = count(3, 5);
        for (int i = 0; i < n; ++i) {
          const Vec2 p = point();
          b.segment(centre, b.vertex(p.x, p.y), count(0, 2));
        }
        break;
      }
      case 2: {  // closed loop
        const Vec2 p = point();
        const Vec2 q = point();
        const KnotIndex i = b.vertex(c.x, c.y);
        const KnotIndex j = b.vertex(p.x, p.y);
        const KnotIndex k = b.vertex(q.x, q.y);
        b.segment(i, j, count(0, 2));
        b.segment(j, k, count(1, 2));
        b.segment(k, i, count(0, 1));
        break;
      }
      case 3: {  // ends on the border
        const KnotIndex inside = b.vertex(c.x, c.y);
        b.segment(b.vertex(uniform(1, width_ - 1), 0), inside, count(0, 2));
        break;
      }
      default:  // from border to border
        b.segment(b.vertex(0, uniform(1, height_ - 1)), b.vertex(width_, uniform(1, height_ - 1)),
                  count(0, 3));
    }
  }

  std::mt19937_64 random_;
  double width_ = 0;
  double height_ = 0;
};

}  // namespace

MeshBuilder::MeshBuilder(double width, double height) : mesh_(mesh::make_domain(width, height)) {}

KnotIndex MeshBuilder::add(Vec2 p, KnotKind kind) {
  const auto index = static_cast<KnotIndex>(mesh_.knots.size());
  mesh_.knots.push_back({p, kind, mesh::KnotId{index}});
  return index;
}

void MeshBuilder::segment(KnotIndex from, KnotIndex to, int knots_inside) {
  const Vec2 a = mesh_.knots[from].position;
  const Vec2 d = mesh_.knots[to].position - a;
  mesh::FeatureSegment s;
  s.knots.push_back(from);
  for (int i = 1; i <= knots_inside; ++i) {
    s.knots.push_back(add(a + (static_cast<double>(i) / (knots_inside + 1)) * d, KnotKind::kSegment));
  }
  s.knots.push_back(to);
  mesh_.segments.push_back(s);
}

KnotMesh MeshBuilder::triangulated() const {
  KnotMesh mesh = mesh_;
  mesh::triangulate(mesh);
  return mesh;
}

std::string MeshCase::to_text() const {
  std::ostringstream text;
  text.precision(17);
  text << "case " << name << ' ' << mesh.width << ' ' << mesh.height << '\n';
  for (const mesh::Knot& k : mesh.knots) {
    text << "knot " << kind_name(k.kind) << ' ' << k.position.x << ' ' << k.position.y << '\n';
  }
  for (const auto& s : mesh.segments) {
    text << "segment";
    for (const KnotIndex k : s.knots) text << ' ' << k;
    text << '\n';
  }
  return text.str();
}

std::vector<MeshCase> corpus_cases() {
  std::vector<MeshCase> cases = read_corpus(KNOTREEL_TEST_DATA "/mesh_corpus.txt");
  const std::size_t n = cases.size();
  for (std::size_t i = 0; i < n; ++i) {
    cases.push_back({cases[i].name + "-mirrored", transformed(cases[i].mesh, false, true)});
    cases.push_back({cases[i].name + "-turned", transformed(cases[i].mesh, true, true)});
  }
  return cases;
}

std::vector<MeshCase> random_cases(std::uint64_t seed, int count) {
  std::vector<MeshCase> cases;
  for (std::uint64_t s = seed; static_cast<int>(cases.size()) < count; ++s) {
    try {
      cases.push_back({"random-" + std::to_string(s), RandomMesh(s).make()});
    } catch (const Error&) {
      // Random features may cross, and random knots may coincide: such a seed makes no case.
    }
  }
  return cases;
}

std::vector<MeshCase> fewer_if_checked(std::vector<MeshCase> cases) {
#ifdef KNOTREEL_CHECKED
  std::vector<MeshCase> some;
  for (std::size_t i = 0; i < cases.size(); i += 3) some.push_back(std::move(cases[i]));
  return some;
#else
  return cases;
#endif
}

bool has_accidental_lines(const KnotMesh& mesh) {
  const auto n = static_cast<KnotIndex>(mesh.knots.size());
  std::vector<std::vector<std::size_t>> lines(n);
  for (std::size_t s = 0; s < mesh.segments.size(); ++s) {
    for (const KnotIndex k : mesh.segments[s].knots) lines[k].push_back(s);
  }
  const std::size_t sides = mesh.segments.size();
  for (KnotIndex k = 0; k < n; ++k) {
    const Vec2 p = mesh.knots[k].position;
    if (p.x == 0) lines[k].push_back(sides);
    if (p.y == 0) lines[k].push_back(sides + 1);
    if (p.x == mesh.width) lines[k].push_back(sides + 2);
    if (p.y == mesh.height) lines[k].push_back(sides + 3);
  }
  const auto share_a_line = [&](KnotIndex a, KnotIndex b, KnotIndex c) {
    return std::any_of(lines[a].begin(), lines[a].end(), [&](std::size_t l) {
      const auto on = [l](const std::vector<std::size_t>& v) {
        return std::find(v.begin(), v.end(), l) != v.end();
      };
      return on(lines[b]) && on(lines[c]);
    });
  };
  for (KnotIndex a = 0; a < n; ++a) {
    for (KnotIndex b = a + 1; b < n; ++b) {
      for (KnotIndex c = b + 1; c < n; ++c) {
        const Vec2 p = mesh.knots[b].position - mesh.knots[a].position;
        const Vec2 q = mesh.knots[c].position - mesh.knots[a].position;
        const double length2 = std::max({dot(p, p), dot(q, q), dot(q - p, q - p)});
        if (std::abs(cross(p, q)) <= 1e-9 * length2 && !share_a_line(a, b, c)) return true;
      }
    }
  }
  return false;
}

std::vector<Vec2> probe_points(const KnotMesh& mesh, std::uint64_t seed, int random_count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec2> points;
  for (const mesh::Knot& k : mesh.knots) points.push_back(k.position);
  for (const mesh::Face& f : mesh.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 a = mesh.knots[f[i]].position;
      const Vec2 b = mesh.knots[f[(i + 1) % 3]].position;
      points.push_back(a + 0.5 * (b - a));
      points.push_back(a + unit(random) * (b - a));
    }
  }
  for (int i = 0; i < random_count; ++i) {
    points.push_back({unit(random) * mesh.width, unit(random) * mesh.height});
  }
  for (Vec2& p : points) {
    p.x = std::clamp(p.x, 0.0, mesh.width);
    p.y = std::clamp(p.y, 0.0, mesh.height);
  }
  return points;
}

}  // namespace knotreel::testing
