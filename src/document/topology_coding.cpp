#include "document/topology_coding.h"

#include <algorithm>

#include "document/identity.h"

namespace knotreel::document {
namespace {

constexpr std::size_t kStepsPerByte = 3;

// No more link codes than this per knot: a mesh has fewer than 6 half edges per knot, level 1 of the links
// has a code per half edge at most, level 2 two per half edge of level 1.
constexpr std::size_t kMostCodesPerKnot = 18;

/// Neighbours of every knot, ascending.
class Neighbours {
 public:
  explicit Neighbours(const mesh::KnotMesh& mesh) : begin_(mesh.knots.size() + 1) {
    std::vector<std::pair<KnotIndex, KnotIndex>> pairs;
    pairs.reserve(6 * mesh.faces.size());
    for (const Face& f : mesh.faces) {
      for (std::size_t i = 0; i < 3; ++i) {
        pairs.emplace_back(f[i], f[(i + 1) % 3]);
        pairs.emplace_back(f[(i + 1) % 3], f[i]);
      }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    for (const auto& [from, to] : pairs) {
      ++begin_[from + 1];
      to_.push_back(to);
    }
    for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
  }

  std::span<const KnotIndex> of(KnotIndex k) const {
    return std::span(to_).subspan(begin_[k], begin_[k + 1] - begin_[k]);
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<KnotIndex> to_;
};

// A segment: its first knot as the distance from that of the segment before, then for every further knot its
// place among the neighbours of the one before, from 1 on, and 0 as the end.

void write_segments(const mesh::KnotMesh& mesh, StreamWriter& streams, ByteWriter& out) {
  std::vector<std::uint64_t> symbols;
  if (!mesh.segments.empty()) {
    const Neighbours neighbours(mesh);
    KnotIndex last_start = 0;
    for (const mesh::FeatureSegment& s : mesh.segments) {
      symbols.push_back(s.knots.front() - last_start);
      last_start = s.knots.front();
      for (std::size_t i = 1; i < s.knots.size(); ++i) {
        const auto around = neighbours.of(s.knots[i - 1]);
        const auto it = std::lower_bound(around.begin(), around.end(), s.knots[i]);
        symbols.push_back(static_cast<std::uint64_t>(it - around.begin()) + 1);
      }
      symbols.push_back(0);
    }
  }
  streams.integers(out, symbols);
}

void read_segments(std::size_t count, mesh::KnotMesh& mesh, StreamReader& streams, ByteReader& in) {
  const std::size_t knots = mesh.knots.size();
  Symbols<std::uint64_t> symbols = streams.integers(in, 16 * knots);
  if (count > 0) {
    const Neighbours neighbours(mesh);
    std::uint64_t start = 0;
    mesh.segments.resize(count);
    for (mesh::FeatureSegment& s : mesh.segments) {
      start += symbols.next();
      if (start >= knots) malformed("a segment starts at no knot");
      s.knots.push_back(static_cast<KnotIndex>(start));
      for (std::uint64_t rank = symbols.next(); rank != 0; rank = symbols.next()) {
        const auto around = neighbours.of(s.knots.back());
        if (rank > around.size()) malformed("a segment leaves the mesh");
        s.knots.push_back(around[rank - 1]);
      }
      if (s.knots.size() < 2) malformed("a segment has one knot");
    }
  }
  if (!symbols.used_up()) malformed("more segments than stated");
}

// Ids. In a keyframe the difference to the id before plus one, so that ids 0, 1, 2, ... cost nothing. In
// other frames a reference to a knot of the frame before, or 0 and the difference to the highest id so far
// plus one.

std::uint32_t id_of(const mesh::KnotMesh& mesh, std::size_t k) {
  return static_cast<std::uint32_t>(mesh.knots[k].id);
}

std::int64_t id_after_highest(const mesh::KnotMesh& mesh) {
  std::int64_t next = 0;
  for (std::size_t k = 0; k < mesh.knots.size(); ++k) next = std::max(next, std::int64_t{id_of(mesh, k)} + 1);
  return next;
}

void write_ids(const mesh::KnotMesh& mesh, const mesh::KnotMesh* before, StreamWriter& streams,
               ByteWriter& out) {
  std::vector<std::uint64_t> symbols;
  if (!before) {
    std::int64_t expected = 0;
    for (std::size_t k = 0; k < mesh.knots.size(); ++k) {
      symbols.push_back(zigzag(id_of(mesh, k) - expected));
      expected = std::int64_t{id_of(mesh, k)} + 1;
    }
  } else {
    const std::vector<std::uint32_t> matches = match_knots(mesh, *before);
    std::int64_t expected = 0;
    std::int64_t expected_id = id_after_highest(*before);
    for (std::size_t k = 0; k < mesh.knots.size(); ++k) {
      if (matches[k] != kNoMatch) {
        symbols.push_back(zigzag(matches[k] - expected) + 1);
        expected = std::int64_t{matches[k]} + 1;
      } else {
        symbols.push_back(0);
        symbols.push_back(zigzag(id_of(mesh, k) - expected_id));
        expected_id = std::max(expected_id, std::int64_t{id_of(mesh, k)} + 1);
      }
    }
  }
  streams.integers(out, symbols);
}

std::uint32_t checked_id(std::int64_t id) {
  if (id < 0 || id > 0xffffffff) malformed("a knot id is out of range");
  return static_cast<std::uint32_t>(id);
}

void read_ids(mesh::KnotMesh& mesh, const mesh::KnotMesh* before, StreamReader& streams, ByteReader& in) {
  Symbols<std::uint64_t> symbols = streams.integers(in, 2 * mesh.knots.size());
  std::int64_t expected = 0;
  std::int64_t expected_id = before ? id_after_highest(*before) : 0;
  for (mesh::Knot& knot : mesh.knots) {
    const std::uint64_t symbol = symbols.next();
    if (before && symbol != 0) {
      const std::int64_t match = expected + unzigzag(symbol - 1);
      if (match < 0 || match >= static_cast<std::int64_t>(before->knots.size())) {
        malformed("a knot refers to none of the frame before");
      }
      knot.id = before->knots[static_cast<std::size_t>(match)].id;
      expected = match + 1;
      continue;
    }
    const std::uint32_t id = checked_id(expected_id + unzigzag(before ? symbols.next() : symbol));
    knot.id = KnotId{id};
    expected_id = before ? std::max(expected_id, std::int64_t{id} + 1) : std::int64_t{id} + 1;
  }
  if (!symbols.used_up()) malformed("more knot ids than knots");
}

void write_link_codes(const std::vector<std::uint16_t>& codes, StreamWriter& streams, ByteWriter& out) {
  const std::vector<std::uint64_t> symbols(codes.begin(), codes.end());
  out.varint(codes.size());
  streams.integers(out, symbols);
}

std::vector<std::uint16_t> read_link_codes(std::size_t knots, StreamReader& streams, ByteReader& in) {
  const std::size_t count = in.varint_in(0, kMostCodesPerKnot * knots, "number of link codes");
  Symbols<std::uint64_t> symbols = streams.integers(in, count);
  std::vector<std::uint16_t> codes(count);
  for (std::uint16_t& code : codes) {
    const std::uint64_t symbol = symbols.next();
    if (symbol > 0xffff) malformed("a link code is out of range");
    code = static_cast<std::uint16_t>(symbol);
  }
  return codes;
}

}  // namespace

void write_topology(const mesh::KnotMesh& mesh, const Conquest& conquest,
                    const std::array<KnotIndex, 4>& domain_corners,
                    const std::vector<std::uint16_t>& link_codes, const mesh::KnotMesh* knots_before,
                    StreamWriter& streams, ByteWriter& out) {
  const std::size_t border = mesh.knots.size() - conquest.discoveries.size();
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t end = i == 3 ? border : domain_corners[i + 1];
    out.varint(end - domain_corners[i] - 1);
  }
  out.varint(conquest.discoveries.size());
  out.varint(mesh.segments.size());

  std::vector<std::uint8_t> packed((conquest.steps.size() + kStepsPerByte - 1) / kStepsPerByte);
  for (std::size_t i = 0; i < conquest.steps.size(); ++i) {
    std::uint8_t& byte = packed[i / kStepsPerByte];
    byte = static_cast<std::uint8_t>(byte | (conquest.steps[i] << (2 * (i % kStepsPerByte))));
  }
  streams.bytes(out, packed);
  streams.integers(out, conquest.splits);
  write_segments(mesh, streams, out);
  write_ids(mesh, knots_before, streams, out);
  write_link_codes(link_codes, streams, out);
}

Topology read_topology(std::size_t most_knots, const mesh::KnotMesh* knots_before, StreamReader& streams,
                       ByteReader& in) {
  Topology t;
  std::size_t border = 0;
  for (KnotIndex& corner : t.domain_corners) {
    corner = static_cast<KnotIndex>(border);
    border += 1 + in.varint_in(0, most_knots, "number of knots on a side");
  }
  const std::size_t inside = in.varint_in(0, most_knots, "number of knots inside");
  const std::size_t knots = border + inside;
  if (knots > most_knots) malformed("more knots than a frame of this size may have");
  const std::size_t segments = in.varint_in(0, 3 * knots, "number of segments");
  t.border_count = static_cast<KnotIndex>(border);

  const std::size_t face_count = 2 * knots - border - 2;
  Symbols<std::uint8_t> packed = streams.bytes(in, (face_count + kStepsPerByte - 1) / kStepsPerByte);
  std::vector<std::uint8_t> unpacked(face_count);
  for (std::size_t i = 0; i < face_count; i += kStepsPerByte) {
    const std::uint8_t byte = packed.next();
    if (byte >> (2 * kStepsPerByte) != 0) malformed("unknown symbol in the connectivity");
    for (std::size_t j = i; j < std::min(face_count, i + kStepsPerByte); ++j) {
      unpacked[j] = (byte >> (2 * (j - i))) & 3;
    }
  }
  Symbols<std::uint8_t> steps(std::move(unpacked));
  Symbols<std::uint64_t> splits = streams.integers(in, face_count);
  Conquest conquest = replay(knots, border, steps, splits);
  if (!splits.used_up()) malformed("more splits than the connectivity needs");
  t.mesh.faces = std::move(conquest.faces);
  t.discoveries = std::move(conquest.discoveries);
  t.mesh.knots.resize(knots);

  read_segments(segments, t.mesh, streams, in);
  set_kinds(t.mesh, t.border_count, t.domain_corners);
  read_ids(t.mesh, knots_before, streams, in);
  t.link_codes = read_link_codes(knots, streams, in);
  return t;
}

}  // namespace knotreel::document
