// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/export/tessellate.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "export/sheets.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::exporting {

namespace {

// Edges shorter than this, in pixels of the parametric domain, are not halved any more.
constexpr double kShortestEdge = 1.0 / 64;
// Linear interpolation of a quadratic over a triangle is off by at most 4/3 of the largest error in the
// middle of an edge, so edges have to be better than what is promised for the whole.
constexpr double kEdgeShare = 0.7;
// How often a triangle whose edges are good may be divided because its middle is not.
constexpr int kMaxInner = 3;
// Where the samples on an edge miss a kink, the edge counts as good and the same line a hair beside it does
// not; triangles over that edge would then be divided without end. Triangles this much flatter than their
// face leave their inner edges whole.
constexpr double kFlattest = 0.02;

Vec2 middle_of(Vec2 a, Vec2 b) {
  return 0.5 * (a + b);
}

SurfacePoint mean(const SurfacePoint& a, const SurfacePoint& b) {
  SurfacePoint m{middle_of(a.u, b.u), middle_of(a.x, b.x), {}};
  for (std::size_t c = 0; c < 4; ++c) m.colour[c] = 0.5 * (a.colour[c] + b.colour[c]);
  return m;
}

}  // namespace

void check_tolerances(const TessellationOptions& options) {
  const auto in_range = [](double v, double low, double high) { return v >= low && v <= high; };
  if (!in_range(options.colour_tolerance, 0.01, 255) || !in_range(options.geometry_tolerance, 0.001, 100)) {
    throw Error(ErrorKind::kInvalidArgument,
                "the tolerance of an export must be 0.01 to 255 levels and 0.001 to 100 pixels");
  }
}

Tessellator::Tessellator(const document::FrameModel& model, const TessellationOptions& options)
    : options_(options), sheets_(std::make_unique<Sheets>(model)) {
  check_tolerances(options);
  feature_parameters_.resize(sheets_->half_edge_count());
  parallel_for(sheets_->half_edge_count(), [&](std::size_t i) {
    const auto h = static_cast<std::uint32_t>(i);
    if (sheets_->is_feature(h) && h < sheets_->opposite(h)) divide_feature(h);
  });
}

Tessellator::~Tessellator() = default;

std::size_t Tessellator::face_count() const {
  return sheets_->faces().size();
}

/// Difference of two points in units of the tolerances.
double Tessellator::error(const SurfacePoint& point, const SurfacePoint& wanted) const {
  double worst = norm(point.x - wanted.x) / options_.geometry_tolerance;
  for (std::size_t c = 0; c < 4; ++c) {
    worst = std::max(worst, std::abs(point.colour[c] - wanted.colour[c]) / options_.colour_tolerance);
  }
  return worst;
}

namespace {

/// Whether to halve the edge a-b, given its middle point and a way to get others: the quarter points catch
/// what is odd about the middle.
template <class ErrorOf, class At>
bool halve(const SurfacePoint& a, const SurfacePoint& middle, const SurfacePoint& b, const ErrorOf& error,
           const At& at) {
  if (!(norm(b.u - a.u) > kShortestEdge)) return false;
  const SurfacePoint m = mean(a, b);
  return error(m, middle) > kEdgeShare || error(mean(a, m), at(middle_of(a.u, middle.u))) > kEdgeShare ||
         error(mean(m, b), at(middle_of(middle.u, b.u))) > kEdgeShare;
}

/// Dyadic parameters between t0 and t1 where `wanted(t0, t1)` asks for them, ascending.
template <class Wanted>
void collect(double t0, double t1, const Wanted& wanted, std::vector<double>& out) {
  if (!wanted(t0, t1)) return;
  const double t = 0.5 * (t0 + t1);
  collect(t0, t, wanted, out);
  out.push_back(t);
  collect(t, t1, wanted, out);
}

}  // namespace

/// Fills in feature_parameters_ of both sides: a point that one side needs, both get.
void Tessellator::divide_feature(std::uint32_t half_edge) {
  const auto error_of = [&](const SurfacePoint& p, const SurfacePoint& q) { return error(p, q); };
  const auto wanted_by = [&](std::uint32_t h, double t0, double t1) {
    const auto at = [&](Vec2 u) { return sheets_->beside(h, u); };
    return halve(sheets_->on_edge(h, t0), sheets_->on_edge(h, 0.5 * (t0 + t1)), sheets_->on_edge(h, t1),
                 error_of, at);
  };
  const std::uint32_t o = sheets_->opposite(half_edge);
  std::vector<double> parameters{0};
  collect(
      0, 1,
      [&](double t0, double t1) { return wanted_by(half_edge, t0, t1) || wanted_by(o, 1 - t0, 1 - t1); },
      parameters);
  parameters.push_back(1);
  std::vector<double> turned(parameters.rbegin(), parameters.rend());
  for (double& t : turned) t = 1 - t;  // exact: the parameters are multiples of a power of two
  feature_parameters_[half_edge] = std::move(parameters);
  feature_parameters_[o] = std::move(turned);
}

std::vector<double> Tessellator::edge_parameters(std::uint32_t half_edge) const {
  if (sheets_->is_feature(half_edge)) return feature_parameters_[half_edge];
  const auto error_of = [&](const SurfacePoint& p, const SurfacePoint& q) { return error(p, q); };
  const auto at = [&](Vec2 u) { return sheets_->at(u); };
  std::vector<double> parameters{0};
  collect(
      0, 1,
      [&](double t0, double t1) {
        return halve(sheets_->on_edge(half_edge, t0), sheets_->on_edge(half_edge, 0.5 * (t0 + t1)),
                     sheets_->on_edge(half_edge, t1), error_of, at);
      },
      parameters);
  parameters.push_back(1);
  return parameters;
}

/// Divides one face; see Tessellator::face.
class FaceRefiner {
 public:
  FaceRefiner(const Tessellator& tessellator, std::uint32_t face,
              const std::function<void(std::size_t)>& spend)
      : tessellator_(tessellator), sheets_(tessellator.sheets()), face_(face), spend_(spend) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const SurfacePoint& corner = sheets_.at_corner(sheets_.origin(3 * face + i));
      std::array<double, 3> weight{};
      weight[i] = 1;
      add(corner, weight);
    }
    face_shape_ = shape(0, 1, 2);
  }

  Patch run() {
    refine(0, 1, 2, kMaxInner);
    if (spend_) spend_(patch_.triangles.size() % kSpentAtOnce);
    return std::move(patch_);
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::size_t kSpentAtOnce = 1024;

  std::uint32_t add(const SurfacePoint& point, const std::array<double, 3>& weight) {
    patch_.vertices.push_back(point);
    patch_.weights.push_back(weight);
    return static_cast<std::uint32_t>(patch_.weights.size() - 1);
  }

  /// The half edge of the face that two vertices lie on, if they do. Weights along edges are dyadic, so zero
  /// is exact.
  std::uint32_t edge_through(std::uint32_t a, std::uint32_t b) const {
    for (std::size_t i = 0; i < 3; ++i) {
      if (patch_.weights[a][i] == 0 && patch_.weights[b][i] == 0) {
        return 3 * face_ + static_cast<std::uint32_t>((i + 1) % 3);
      }
    }
    return kNone;
  }

  /// Area in squares of the longest edge.
  double shape(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const double longest = std::max({length(a, b), length(b, c), length(c, a)});
    const auto& v = patch_.vertices;
    return std::abs(signed_area(v[a].u, v[b].u, v[c].u)) / std::max(longest * longest, 1e-300);
  }

  /// The vertex that halves edge a-b, or kNone. What is decided first holds for both triangles of an edge.
  std::uint32_t middle(std::uint32_t a, std::uint32_t b, bool flat) {
    const std::uint64_t key = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
    const auto known = middles_.find(key);
    if (known != middles_.end()) return known->second;
    return middles_[key] = find_middle(a, b, flat);
  }

  std::uint32_t find_middle(std::uint32_t a, std::uint32_t b, bool flat) {
    const SurfacePoint& pa = patch_.vertices[a];
    const SurfacePoint& pb = patch_.vertices[b];
    std::array<double, 3> weight{};
    for (std::size_t i = 0; i < 3; ++i) weight[i] = 0.5 * (patch_.weights[a][i] + patch_.weights[b][i]);
    const Vec2 u = middle_of(pa.u, pb.u);
    const std::uint32_t h = edge_through(a, b);
    if (h != kNone && sheets_.is_feature(h)) {
      const auto& wanted = tessellator_.feature_parameters_[h];
      const double t = weight[(h + 1) % 3];
      if (!std::binary_search(wanted.begin(), wanted.end(), t)) return kNone;
      return add(sheets_.beside(h, u), weight);
    }
    if (h == kNone && flat) return kNone;
    const SurfacePoint m = sheets_.at(u);
    const auto error_of = [&](const SurfacePoint& p, const SurfacePoint& q) {
      return tessellator_.error(p, q);
    };
    if (!halve(pa, m, pb, error_of, [&](Vec2 v) { return sheets_.at(v); })) return kNone;
    return add(m, weight);
  }

  void refine(std::uint32_t a, std::uint32_t b, std::uint32_t c, int inner) {
    // Turned so that unhalved edges come last: ab, then bc, then ca.
    const bool flat = shape(a, b, c) < kFlattest * face_shape_;
    std::uint32_t ab = middle(a, b, flat);
    std::uint32_t bc = middle(b, c, flat);
    std::uint32_t ca = middle(c, a, flat);
    for (int turn = 0; turn < 2 && (ab == kNone || (bc == kNone && ca != kNone)); ++turn) {
      std::swap(a, b);
      std::swap(b, c);
      std::swap(ab, bc);
      std::swap(bc, ca);
    }
    if (ab == kNone) {
      finish(a, b, c, inner);
    } else if (bc == kNone) {
      refine(a, ab, c, inner);
      refine(ab, b, c, inner);
    } else if (ca == kNone) {
      refine(ab, b, bc, inner);
      if (length(a, bc) <= length(ab, c)) {
        refine(a, ab, bc, inner);
        refine(a, bc, c, inner);
      } else {
        refine(ab, bc, c, inner);
        refine(a, ab, c, inner);
      }
    } else {
      refine(a, ab, ca, inner);
      refine(ab, bc, ca, inner);
      refine(ab, b, bc, inner);
      refine(ca, bc, c, inner);
    }
  }

  double length(std::uint32_t a, std::uint32_t b) const {
    return norm(patch_.vertices[a].u - patch_.vertices[b].u);
  }

  /// A triangle with good edges: one more look at its middle.
  void finish(std::uint32_t a, std::uint32_t b, std::uint32_t c, int inner) {
    const auto& v = patch_.vertices;
    if (inner > 0 && std::max({length(a, b), length(b, c), length(c, a)}) > kShortestEdge) {
      const auto third = [](auto p, auto q, auto r) { return (1.0 / 3) * (p + q + r); };
      SurfacePoint linear{third(v[a].u, v[b].u, v[c].u), third(v[a].x, v[b].x, v[c].x), {}};
      for (std::size_t k = 0; k < 4; ++k) {
        linear.colour[k] = third(v[a].colour[k], v[b].colour[k], v[c].colour[k]);
      }
      const SurfacePoint centre = sheets_.at(linear.u);
      if (tessellator_.error(linear, centre) > 1) {
        std::array<double, 3> weight{};
        for (std::size_t i = 0; i < 3; ++i) {
          weight[i] = third(patch_.weights[a][i], patch_.weights[b][i], patch_.weights[c][i]);
        }
        const std::uint32_t m = add(centre, weight);
        refine(a, b, m, inner - 1);
        refine(b, c, m, inner - 1);
        refine(c, a, m, inner - 1);
        return;
      }
    }
    patch_.triangles.push_back({a, b, c});
    if (spend_ && patch_.triangles.size() % kSpentAtOnce == 0) spend_(kSpentAtOnce);
  }

  const Tessellator& tessellator_;
  const Sheets& sheets_;
  std::uint32_t face_;
  const std::function<void(std::size_t)>& spend_;
  double face_shape_ = 0;
  Patch patch_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;
};

Patch Tessellator::face(std::size_t face, const std::function<void(std::size_t)>& spend) const {
  return FaceRefiner(*this, static_cast<std::uint32_t>(face), spend).run();
}

}  // namespace knotreel::exporting
