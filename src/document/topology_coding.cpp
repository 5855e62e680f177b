// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/topology_coding.h"

#include <algorithm>
#include <optional>

#include "document/edge_table.h"
#include "document/identity.h"

namespace knotreel::document {
namespace {

std::uint32_t id_of(const mesh::KnotMesh& mesh, std::size_t k) {
  return static_cast<std::uint32_t>(mesh.knots[k].id);
}

std::int64_t id_after_highest(const mesh::KnotMesh& mesh) {
  std::int64_t next = 0;
  for (std::size_t k = 0; k < mesh.knots.size(); ++k) next = std::max(next, std::int64_t{id_of(mesh, k)} + 1);
  return next;
}

/// Where the third corner at a gate is, if the face there is that of the frame before.
enum class Expectation : std::uint8_t {
  kNone,   ///< there was no such face, or its third knot is gone
  kNew,    ///< a knot not found yet
  kRight,  ///< the knot after the gate
  kLeft,   ///< the knot before the gate
  kSplit,  ///< another one
};

/// One traversal for both directions: the writer is given a complete topology, the reader fills it.
template <class Coder>
class TopologyCoding {
 public:
  TopologyCoding(Coder& coder, TopologyModels& models, const FrameState* before, std::size_t most_knots,
                 Topology& topology)
      : coder_(coder), models_(models), before_(before), most_knots_(most_knots), t_(topology) {
    if (!before) return;
    found_.assign(before->mesh().knots.size(), kNoKnot);
    alive_.assign(found_.size(), true);
    next_id_ = id_after_highest(before->mesh());
  }

  void run() {
    sides();
    for (KnotIndex k = 0; k < t_.border_count; ++k) border_knot(k);
    knots_inside();
    connectivity();
    segments();
  }

 private:
  static constexpr bool kWriting = Coder::kWriting;

  std::uint64_t number(NumberModel& model, std::uint64_t value) { return code_number(coder_, model, value); }

  // --- Knots on the border

  void sides() {
    std::size_t border = 0;
    std::int64_t usual = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      std::int64_t count = 0;
      if constexpr (kWriting) count = side_count(t_.domain_corners, t_.border_count, i);
      if (before_) usual = side_count(before_->domain_corners, before_->border_count, i);
      count = usual + code_signed(coder_, models_.side_count, count - usual);
      if (count < 0 || static_cast<std::uint64_t>(count) > most_knots_) too_many();
      usual = count;
      t_.domain_corners[i] = static_cast<KnotIndex>(border);
      border += 1 + static_cast<std::size_t>(count);
    }
    if (border > most_knots_) too_many();
    t_.border_count = static_cast<KnotIndex>(border);
    if constexpr (!kWriting) t_.mesh.knots.resize(border);
  }

  static std::int64_t side_count(const std::array<KnotIndex, 4>& corners, KnotIndex border,
                                 std::size_t side) {
    return std::int64_t{side == 3 ? border : corners[side + 1]} - corners[side] - 1;
  }

  void border_knot(KnotIndex k) {
    if (!before_) {
      name(k, kNoMatch);
      return;
    }
    std::uint32_t match = kWriting ? t_.matches[k] : kNoMatch;
    const bool can_follow = expected_ < found_.size() && found_[expected_] == kNoKnot;
    if (can_follow && coder_.bit(models_.border_follows, match == expected_)) {
      match = expected_;
    } else if (coder_.bit(models_.border_fresh, match == kNoMatch)) {
      match = kNoMatch;
    } else {
      match = reference(models_.border_reference, match);
    }
    name(k, match);
  }

  /// A knot of the frame before that was not found yet, by its distance from the one found last.
  std::uint32_t reference(SignedModel& model, std::uint32_t match) {
    const std::int64_t at =
        std::int64_t{expected_} + code_signed(coder_, model, std::int64_t{match} - expected_);
    if (at < 0 || at >= static_cast<std::int64_t>(found_.size()) ||
        found_[static_cast<std::size_t>(at)] != kNoKnot) {
      malformed("a knot refers to none of the frame before");
    }
    return static_cast<std::uint32_t>(at);
  }

  /// Identity of knot k: that of a knot before, or a new one.
  void name(KnotIndex k, std::uint32_t match) {
    if constexpr (!kWriting) t_.matches.push_back(match);
    if (match != kNoMatch) {
      found_[match] = k;
      expected_ = match + 1;
      if constexpr (!kWriting) t_.mesh.knots[k].id = before_->mesh().knots[match].id;
      return;
    }
    SignedModel& model = before_ ? models_.fresh_id : models_.keyframe_id;
    const std::int64_t id =
        next_id_ + code_signed(coder_, model, kWriting ? id_of(t_.mesh, k) - next_id_ : 0);
    if (id < 0 || id > 0xffffffff) malformed("a knot id is out of range");
    if constexpr (!kWriting) t_.mesh.knots[k].id = KnotId{static_cast<std::uint32_t>(id)};
    next_id_ = before_ ? std::max(next_id_, id + 1) : id + 1;
  }

  // --- Knots inside

  void knots_inside() {
    std::vector<bool> lives(found_.size());
    std::size_t fresh = 0;
    if constexpr (kWriting) {
      for (std::size_t k = t_.border_count; k < t_.mesh.knots.size(); ++k) {
        if (t_.matches[k] == kNoMatch) {
          ++fresh;
        } else {
          lives[t_.matches[k]] = true;
        }
      }
    }
    std::size_t knots = t_.border_count;
    for (std::size_t p = 0; p < found_.size(); ++p) {
      if (found_[p] != kNoKnot) continue;
      const bool free = before_->mesh().knots[p].kind == KnotKind::kFree;
      alive_[p] = coder_.bit(models_.alive[free ? 1 : 0], lives[p]);
      if (alive_[p]) ++knots;
    }
    fresh_left_ = number(models_.fresh_count, fresh);
    if (fresh_left_ > most_knots_ || (knots += fresh_left_) > most_knots_) too_many();
    if constexpr (!kWriting) t_.mesh.knots.resize(knots);
  }

  [[noreturn]] static void too_many() { malformed("more knots than a frame of this size may have"); }

  // --- Faces

  void connectivity() {
    const std::size_t knots = t_.mesh.knots.size();
    const std::size_t face_count = 2 * knots - t_.border_count - 2;
    if (before_) edges_before_.emplace(before_->mesh().knots.size(), before_->mesh().faces);
    next_knot_ = t_.border_count;
    Loops loops(t_.border_count);
    std::size_t face = 0;
    for (; !loops.done(); ++face) {
      if (face == face_count) malformed("the mesh has more faces than its knots allow");
      const KnotIndex a = loops.a();
      const KnotIndex b = loops.b();
      const KnotIndex x = third_corner(loops, kWriting ? t_.mesh.faces[face][2] : kNoKnot);
      if constexpr (!kWriting) t_.mesh.faces.push_back({a, b, x});
    }
    // With all loops closed, Euler's formula turns the number of faces into the number of knots.
    if (face != face_count) malformed("the mesh has fewer knots than stated");
  }

  KnotIndex third_corner(Loops& loops, KnotIndex given) {
    const std::uint32_t before = apex_before(loops.a(), loops.b());
    const Expectation expectation = expect(loops, before);
    const auto e = static_cast<std::size_t>(expectation);
    if (expectation != Expectation::kNone) {
      const bool is_new = expectation == Expectation::kNew;
      bool meets = false;
      if constexpr (kWriting) {
        meets = is_new ? given == next_knot_ && t_.matches[given] == before : given == found_[before];
      }
      if (coder_.bit(models_.expected[e][surprises_], meets)) {
        surprises_ = (2 * surprises_) % 4;
        return is_new ? discover(loops, before) : go_to(loops, found_[before]);
      }
    }
    surprises_ = (2 * surprises_ + 1) % 4;
    return unexpected(loops, given, before, e);
  }

  /// Third knot of the face that was at an edge in the frame before, or kNoMatch.
  std::uint32_t apex_before(KnotIndex a, KnotIndex b) const {
    if (!before_ || t_.matches[a] == kNoMatch || t_.matches[b] == kNoMatch) return kNoMatch;
    const EdgeTable::Side* side = edges_before_->find(t_.matches[a], t_.matches[b]);
    return side && alive_[side->apex] ? side->apex : kNoMatch;
  }

  Expectation expect(const Loops& loops, std::uint32_t before) const {
    if (before == kNoMatch) return Expectation::kNone;
    const KnotIndex x = found_[before];
    if (x == kNoKnot) return Expectation::kNew;
    if (x == loops.after()) return Expectation::kRight;
    if (x == loops.before()) return Expectation::kLeft;
    return Expectation::kSplit;
  }

  KnotIndex unexpected(Loops& loops, KnotIndex given, std::uint32_t before, std::size_t e) {
    auto& model = models_.step[e][last_steps_];
    if (coder_.bit(model.found, kWriting && given == next_knot_)) {
      return discover(loops, unexpected_knot(loops, before, e));
    }
    if (coder_.bit(model.right, kWriting && given == loops.after())) return go_to(loops, loops.after());
    if (coder_.bit(model.left, kWriting && given == loops.before())) {
      if (loops.length() == 3) malformed("a loop of three knots is closed by a wrong step");
      return go_to(loops, loops.before());
    }
    const std::uint64_t code = number(models_.split, kWriting ? loops.split_code(given) : 0);
    remember(Step::kSplit);
    return loops.split(code);
  }

  /// A knot that is new in this frame (kNoMatch), or an old one that was elsewhere: likely near the gate.
  std::uint32_t unexpected_knot(const Loops& loops, std::uint32_t expected, std::size_t e) {
    if (!before_) return kNoMatch;
    const std::uint32_t match = kWriting ? t_.matches[next_knot_] : kNoMatch;
    if (coder_.bit(models_.fresh[e], match == kNoMatch)) return kNoMatch;
    candidates_.clear();
    for (const KnotIndex end : {loops.a(), loops.b()}) {
      if (t_.matches[end] == kNoMatch) continue;
      for (const EdgeTable::Side& side : edges_before_->from(t_.matches[end])) {
        const std::uint32_t p = side.to;
        if (alive_[p] && found_[p] == kNoKnot && p != expected &&
            std::ranges::find(candidates_, p) == candidates_.end()) {
          candidates_.push_back(p);
        }
      }
    }
    const auto place = std::ranges::find(candidates_, match) - candidates_.begin();
    const std::uint64_t code = number(models_.candidate, static_cast<std::uint64_t>(place));
    if (code > candidates_.size()) malformed("a knot refers to none of the frame before");
    return code < candidates_.size() ? candidates_[code] : reference(models_.reference, match);
  }

  KnotIndex discover(Loops& loops, std::uint32_t match) {
    const KnotIndex x = next_knot_;
    if (x == t_.mesh.knots.size()) malformed("the mesh has more knots than stated");
    ++next_knot_;
    if constexpr (!kWriting) t_.discoveries.push_back({loops.a(), loops.b(), loops.behind()});
    if (match == kNoMatch) {
      if (fresh_left_ == 0) malformed("the mesh has more new knots than stated");
      --fresh_left_;
    }
    name(x, match);
    loops.found(x);
    remember(Step::kNew);
    return x;
  }

  /// To a knot that should be on the loop.
  KnotIndex go_to(Loops& loops, KnotIndex x) {
    if (x == loops.after()) {
      loops.right();
      remember(Step::kRight);
    } else if (x == loops.before()) {
      loops.left();
      remember(Step::kLeft);
    } else {
      loops.split(loops.split_code(x));
      remember(Step::kSplit);
    }
    return x;
  }

  void remember(Step step) { last_steps_ = (4 * last_steps_ + static_cast<std::size_t>(step)) % 16; }

  // --- Segments: those of the frame before that are still there, then the others, each by its first knot as
  // the distance from that of the one before, then for every further knot its place among the neighbours of
  // the knot before, from 1 on, and 0 as the end.

  void segments() {
    std::vector<std::vector<KnotIndex>> others;
    if constexpr (kWriting) {
      for (const auto& s : t_.mesh.segments) others.push_back(s.knots);
    }
    if (before_) {
      for (const mesh::FeatureSegment& s : before_->mesh().segments) {
        const std::vector<KnotIndex> path = path_now(s.knots);
        if (path.empty()) continue;
        const auto same = std::ranges::find(others, path);
        if (!coder_.bit(models_.segment_alive, same != others.end())) continue;
        if constexpr (kWriting) {
          others.erase(same);
        } else {
          t_.mesh.segments.push_back({path});
        }
      }
    }
    const std::uint64_t count = number(models_.segment_count, others.size());
    if (count > 3 * t_.mesh.knots.size()) malformed("too many segments");
    if (count > 0) other_segments(static_cast<std::size_t>(count), others);
    if constexpr (!kWriting) {
      std::ranges::sort(t_.mesh.segments, {}, &mesh::FeatureSegment::knots);
      set_kinds(t_.mesh, t_.border_count, t_.domain_corners);
    }
  }

  /// A segment of the frame before in knots of this one, the smaller end first; empty if one of them is gone.
  std::vector<KnotIndex> path_now(const std::vector<KnotIndex>& before) const {
    std::vector<KnotIndex> path;
    for (const KnotIndex p : before) {
      if (found_[p] == kNoKnot) return {};
      path.push_back(found_[p]);
    }
    if (path.front() > path.back()) std::ranges::reverse(path);
    return path;
  }

  void other_segments(std::size_t count, const std::vector<std::vector<KnotIndex>>& given) {
    const std::size_t knots = t_.mesh.knots.size();
    const EdgeTable edges(knots, t_.mesh.faces);
    std::size_t budget = 16 * knots;  // more steps than any sound mesh has
    std::uint64_t first = 0;
    std::vector<KnotIndex> neighbours;
    for (std::size_t s = 0; s < count; ++s) {
      const auto at = [&](std::size_t i) { return kWriting && i < given[s].size() ? given[s][i] : kNoKnot; };
      first += number(models_.segment_first, kWriting ? at(0) - first : 0);
      if (first >= knots) malformed("a segment starts at no knot");
      std::vector<KnotIndex> path{static_cast<KnotIndex>(first)};
      while (true) {
        if (budget-- == 0) malformed("segments are longer than the mesh");
        neighbours_of(path.back(), edges, neighbours);
        const KnotIndex next = at(path.size());
        const auto place = std::ranges::find(neighbours, next) - neighbours.begin() + 1;
        const std::uint64_t code =
            number(models_.segment_next, next == kNoKnot ? 0 : static_cast<std::uint64_t>(place));
        if (code == 0) break;
        if (code > neighbours.size()) malformed("a segment leaves the mesh");
        path.push_back(neighbours[code - 1]);
      }
      if (path.size() < 2) malformed("a segment has one knot");
      if constexpr (!kWriting) t_.mesh.segments.push_back({std::move(path)});
    }
  }

  /// The knots joined to a knot, ascending.
  static void neighbours_of(KnotIndex k, const EdgeTable& edges, std::vector<KnotIndex>& neighbours) {
    neighbours.clear();
    for (const EdgeTable::Side& side : edges.from(k)) {
      neighbours.push_back(side.to);
      neighbours.push_back(side.apex);
    }
    std::ranges::sort(neighbours);
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  }

  Coder& coder_;
  TopologyModels& models_;
  const FrameState* before_;
  std::size_t most_knots_;
  Topology& t_;

  std::optional<EdgeTable> edges_before_;
  std::vector<KnotIndex> found_;  ///< by knot of the frame before: the same one now, as far as it was met
  std::vector<bool> alive_;       ///< by knot of the frame before
  std::uint32_t expected_ = 0;    ///< the knot of the frame before behind the one found last
  std::int64_t next_id_ = 0;
  std::uint64_t fresh_left_ = 0;
  KnotIndex next_knot_ = 0;
  std::size_t surprises_ = 0;   ///< whether the last two faces were: 0 to 3
  std::size_t last_steps_ = 0;  ///< the last two, 0 to 15
  std::vector<std::uint32_t> candidates_;
};

}  // namespace

void write_topology(const Topology& topology, const FrameState* before, TopologyModels& models,
                    ArithmeticWriter& out) {
  Topology copy = topology;  // the coding is written for both directions and wants places to write to
  TopologyCoding(out, models, before, topology.mesh.knots.size(), copy).run();
}

Topology read_topology(std::size_t most_knots, const FrameState* before, TopologyModels& models,
                       ArithmeticReader& in) {
  Topology topology;
  TopologyCoding(in, models, before, most_knots, topology).run();
  if (before && topology.matches != match_knots(topology.mesh, before->mesh())) {
    malformed("a new knot has the id of an old one");
  }
  return topology;
}

}  // namespace knotreel::document
