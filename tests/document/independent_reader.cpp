// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/independent_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

namespace knotreel::testing {
namespace {

using Integer = std::int64_t;

void require(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error("independent reader: " + what);
}

// --- Section 1: numbers

struct Input {
  const std::vector<std::uint8_t>& bytes;
  std::size_t at;
  std::size_t end;

  std::uint8_t u8() {
    require(at < end, "data end early");
    return bytes[at++];
  }
  std::uint64_t fixed(int size) {
    std::uint64_t v = 0;
    for (int i = 0; i < size; ++i) v |= std::uint64_t{u8()} << (8 * i);
    return v;
  }
  std::uint64_t varint() {
    std::uint64_t v = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint8_t b = u8();
      v |= std::uint64_t{b & 0x7fu} << shift;
      if (b < 128) return v;
    }
  }
  int count() { return static_cast<int>(varint()); }
};

struct Bit {
  int one = 32768;
  int seen = 0;
};

/// Coded bits.
struct Coded {
  Input& in;
  std::uint32_t low = 0;
  std::uint32_t high = 0xffffffff;
  std::uint32_t code = 0;

  explicit Coded(Input& input) : in(input) {
    for (int i = 0; i < 4; ++i) shift_in();
  }
  void shift_in() { code = code * 256 + (in.at < in.end ? in.bytes[in.at++] : 0); }
  bool cut(int one) {
    const std::uint32_t middle =
        low + static_cast<std::uint32_t>(std::uint64_t{high - low} * static_cast<std::uint64_t>(one) / 65536);
    const bool bit = code <= middle;
    (bit ? high : low) = bit ? middle : middle + 1;
    while (low >> 24 == high >> 24) {
      low <<= 8;
      high = high * 256 + 255;
      shift_in();
    }
    return bit;
  }
  bool bit(Bit& m) {
    const bool b = cut(m.one);
    m.one += 2 * ((b ? 65512 : 24) - m.one) / (2 * m.seen + 3);
    m.seen = std::min(m.seen + 1, 160);
    return b;
  }
};

std::size_t size_class(std::uint64_t v) {
  if (v < 4) return static_cast<std::size_t>(v);
  std::size_t e = 0;
  while (v >= 4) {
    v /= 2;
    ++e;
  }
  return 2 * e + static_cast<std::size_t>(v);
}

struct Number {
  std::array<Bit, 24> larger;

  std::uint64_t read(Coded& in) {
    std::size_t c = 0;
    while (in.bit(larger[std::min<std::size_t>(c, 23)])) require(++c <= 121, "a number without end");
    if (c < 4) return c;
    std::uint64_t v = 2 + c % 2;
    for (std::size_t i = 1; i < c / 2; ++i) v = 2 * v + (in.cut(32768) ? 1 : 0);
    return v;
  }
};

struct Signed {
  Number magnitude;
  Bit negative;

  Integer read(Coded& in) {
    const auto v = static_cast<Integer>(magnitude.read(in));
    return v != 0 && in.bit(negative) ? -v : v;
  }
};

/// Differences seen so far near the next one.
struct Around {
  Integer sum = 0;
  Integer size = 0;
  Integer count = 0;
  void add(Integer d) {
    sum += d;
    size += std::abs(d);
    ++count;
  }
  void add(const Around& other) {
    sum += other.sum;
    size += other.size;
    count += other.count;
  }
};

struct Difference {
  std::array<Number, 14> magnitude;
  std::array<Bit, 3> negative;

  Integer read(Coded& in, const Around& around) {
    std::size_t size = 13;
    if (around.count > 0) {
      size =
          std::min<std::size_t>(12, size_class(static_cast<std::uint64_t>(2 * around.size / around.count)));
    }
    const auto v = static_cast<Integer>(magnitude[size].read(in));
    return v != 0 && in.bit(negative[around.sum == 0 ? 0 : around.sum > 0 ? 1 : 2]) ? -v : v;
  }
};

// --- Section 4: topology

struct Gate {
  int a, b, behind;  // behind: -1 at the border
};

struct Topology {
  int border = 0;
  std::array<int, 4> domain_corner{};
  std::vector<Gate> found_at;  // of knot border + i
  enum Kind { kFree, kBorder, kSegment, kVertex };
  std::vector<Kind> kind;
};

void read_id(Coded& in, Signed& id, IndependentModel& model) {
  const Integer expected = model.ids.empty() ? 0 : Integer{model.ids.back()} + 1;
  model.ids.push_back(static_cast<std::uint32_t>(expected + id.read(in)));
}

void read_faces(int knots, Topology& t, Coded& in, IndependentModel& model, Signed& id) {
  struct Steps {
    Bit found, right, left;
  };
  std::array<Steps, 16> models;  // by the last two steps
  Number split;
  std::size_t last = 0;
  std::vector<std::array<int, 3>>& faces = model.faces;
  // A loop begins with its gate: knots[0], knots[1]; behind[i] belongs to the edge from knots[i] to the next.
  struct Loop {
    std::vector<int> knots;
    std::vector<int> behind;
  };
  std::vector<Loop> stack(1);
  for (int k = 0; k < t.border; ++k) {
    stack[0].knots.push_back(k);
    stack[0].behind.push_back(-1);
  }
  int next = t.border;
  while (!stack.empty()) {
    Steps& m = models[last];
    const std::size_t step = in.bit(m.found) ? 0 : in.bit(m.right) ? 1 : in.bit(m.left) ? 2 : 3;
    last = (4 * last + step) % 16;
    Loop& loop = stack.back();
    std::vector<int>& k = loop.knots;
    std::vector<int>& behind = loop.behind;
    const int a = k[0];
    const int b = k[1];
    int x = 0;
    if (step == 0) {
      x = next++;
      t.found_at.push_back({a, b, behind[0]});
      read_id(in, id, model);
      // a, b, rest  ->  x, b, rest, a
      k[0] = x;
      k.push_back(a);
      behind[0] = a;
      behind.push_back(b);
    } else if (step == 1) {
      x = k[2];
      if (k.size() == 3) {
        stack.pop_back();
      } else {
        k.erase(k.begin() + 1);
        behind.erase(behind.begin() + 1);
        behind[0] = b;
      }
    } else if (step == 2) {
      // ..., x, a, b  ->  x, b, ...
      x = k.back();
      k.pop_back();
      behind.pop_back();
      k[0] = x;
      behind[0] = a;
    } else {
      const std::uint64_t v = split.read(in);
      const std::size_t s = v / 2 + 2;
      const std::size_t place = v % 2 == 0 ? 1 + s : k.size() - s;
      x = k[place];
      Loop left;  // a, x, ... back to a
      left.knots.push_back(a);
      left.behind.push_back(b);
      left.knots.insert(left.knots.end(), k.begin() + static_cast<std::ptrdiff_t>(place), k.end());
      left.behind.insert(left.behind.end(), behind.begin() + static_cast<std::ptrdiff_t>(place),
                         behind.end());
      Loop right;  // x, b, ... up to the knot before x
      right.knots.push_back(x);
      right.behind.push_back(a);
      right.knots.insert(right.knots.end(), k.begin() + 1, k.begin() + static_cast<std::ptrdiff_t>(place));
      right.behind.insert(right.behind.end(), behind.begin() + 1,
                          behind.begin() + static_cast<std::ptrdiff_t>(place));
      stack.back() = left;
      stack.push_back(right);
    }
    faces.push_back({a, b, x});
  }
  require(next == knots && static_cast<int>(faces.size()) == 2 * knots - t.border - 2, "connectivity");
}

Topology read_topology(Coded& in, IndependentModel& model) {
  Topology t;
  Signed side_count;
  Integer count = 0;
  for (std::size_t side = 0; side < 4; ++side) {
    t.domain_corner[side] = t.border;
    count += side_count.read(in);
    t.border += 1 + static_cast<int>(count);
  }
  Signed id;
  for (int k = 0; k < t.border; ++k) read_id(in, id, model);
  Number fresh_count;
  const int knots = t.border + static_cast<int>(fresh_count.read(in));
  read_faces(knots, t, in, model, id);

  std::vector<std::set<int>> neighbours(static_cast<std::size_t>(knots));
  for (const auto& f : model.faces) {
    for (const int x : f) {
      for (const int y : f) {
        if (x != y) neighbours[static_cast<std::size_t>(x)].insert(y);
      }
    }
  }
  Number segment_count;
  Number segment_first;
  Number segment_next;
  int first = 0;
  for (auto left = segment_count.read(in); left > 0; --left) {
    first += static_cast<int>(segment_first.read(in));
    std::vector<int> path{first};
    for (auto rank = segment_next.read(in); rank != 0; rank = segment_next.read(in)) {
      path.push_back(*std::next(neighbours[static_cast<std::size_t>(path.back())].begin(),
                                static_cast<std::ptrdiff_t>(rank) - 1));
    }
    model.segments.push_back(path);
  }

  t.kind.assign(static_cast<std::size_t>(knots), Topology::kFree);
  for (int k = 0; k < t.border; ++k) t.kind[static_cast<std::size_t>(k)] = Topology::kBorder;
  for (const auto& s : model.segments) {
    for (std::size_t i = 1; i + 1 < s.size(); ++i)
      t.kind[static_cast<std::size_t>(s[i])] = Topology::kSegment;
  }
  for (const auto& s : model.segments) {
    t.kind[static_cast<std::size_t>(s.front())] = t.kind[static_cast<std::size_t>(s.back())] =
        Topology::kVertex;
  }
  for (const int k : t.domain_corner) t.kind[static_cast<std::size_t>(k)] = Topology::kVertex;
  return t;
}

// --- Section 6: positions, for a keyframe

struct Grid {
  Integer x, y;
};

Integer floor_div(Integer a, Integer b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

void read_positions(Coded& in, int bits, const Topology& t, IndependentModel& model) {
  Difference border;
  Difference vertex;
  Difference parameter;
  Difference free_x;
  Difference free_y;
  Around latest;
  const auto next = [&](Difference& model_of) {
    const Integer d = model_of.read(in, latest);
    latest = {};
    latest.add(d);
    return d;
  };
  const Integer w = Integer{model.width} << bits;
  const Integer h = Integer{model.height} << bits;
  const std::size_t knots = t.kind.size();
  std::vector<Grid> grid(knots);
  std::vector<Integer> place(knots);

  for (std::size_t side = 0; side < 4; ++side) {
    const Integer length = side % 2 == 0 ? w : h;
    const int end = side == 3 ? t.border : t.domain_corner[side + 1];
    Integer last = 0;
    for (int k = t.domain_corner[side]; k < end; ++k) {
      Integer s = 0;
      if (k > t.domain_corner[side]) s = last + floor_div(length - last, end - k + 1) + next(border);
      last = s;
      const Grid points[] = {{s, 0}, {w, s}, {w - s, h}, {0, h - s}};
      grid[static_cast<std::size_t>(k)] = points[side];
    }
  }
  Grid last{floor_div(w, 2), floor_div(h, 2)};
  latest = {};
  for (std::size_t k = static_cast<std::size_t>(t.border); k < knots; ++k) {
    if (t.kind[k] != Topology::kVertex) continue;
    for (const auto& s : model.segments) {
      if (s.back() != static_cast<int>(k)) continue;
      last = grid[static_cast<std::size_t>(s.front())];
      break;
    }
    last.x += next(vertex);
    last.y += next(vertex);
    grid[k] = last;
  }
  latest = {};
  for (const auto& s : model.segments) {
    const Grid a = grid[static_cast<std::size_t>(s.front())];
    const Grid b = grid[static_cast<std::size_t>(s.back())];
    Integer t0 = 0;
    for (std::size_t i = 1; i + 1 < s.size(); ++i) {
      t0 += floor_div(65536 - t0, static_cast<Integer>(s.size() - i)) + next(parameter);
      const auto k = static_cast<std::size_t>(s[i]);
      place[k] = t0;
      grid[k] = {a.x + floor_div(t0 * (b.x - a.x), 65536), a.y + floor_div(t0 * (b.y - a.y), 65536)};
    }
  }
  for (std::size_t k = static_cast<std::size_t>(t.border); k < knots; ++k) {
    if (t.kind[k] != Topology::kFree) continue;
    const Gate& gate = t.found_at[k - static_cast<std::size_t>(t.border)];
    const Grid a = grid[static_cast<std::size_t>(gate.a)];
    const Grid b = grid[static_cast<std::size_t>(gate.b)];
    Grid p{};
    if (gate.behind >= 0) {
      const Grid c = grid[static_cast<std::size_t>(gate.behind)];
      p = {std::clamp<Integer>(a.x + b.x - c.x, 0, w), std::clamp<Integer>(a.y + b.y - c.y, 0, h)};
    } else {
      p = {std::clamp<Integer>(floor_div(a.x + b.x, 2) - floor_div(7 * (b.y - a.y), 8), 0, w),
           std::clamp<Integer>(floor_div(a.y + b.y, 2) + floor_div(7 * (b.x - a.x), 8), 0, h)};
    }
    // No knot around was in a frame before; y only knows of x.
    const Integer x = free_x.read(in, {});
    Around beside;
    beside.size = std::abs(x);
    beside.count = 1;
    grid[k] = {p.x + x, p.y + free_y.read(in, beside)};
  }

  const double unit = 1.0 / static_cast<double>(1 << bits);
  for (const Grid& g : grid)
    model.knots.push_back({static_cast<double>(g.x) * unit, static_cast<double>(g.y) * unit});
  for (const auto& s : model.segments) {
    const Point a = model.knots[static_cast<std::size_t>(s.front())];
    const Point b = model.knots[static_cast<std::size_t>(s.back())];
    for (std::size_t i = 1; i + 1 < s.size(); ++i) {
      const double along = static_cast<double>(place[static_cast<std::size_t>(s[i])]) / 65536;
      model.knots[static_cast<std::size_t>(s[i])] = {a[0] + along * (b[0] - a[0]),
                                                     a[1] + along * (b[1] - a[1])};
    }
  }
}

// --- Section 5: basis functions

using Edge = std::pair<int, int>;
using Family = std::vector<IndependentModel::Config>;

/// Cut faces; numbers the corners.
std::vector<std::array<int, 3>> cut_open(const Topology& t, IndependentModel& model) {
  std::set<Edge> walls;
  for (const auto& s : model.segments) {
    for (std::size_t i = 1; i < s.size(); ++i) {
      walls.insert({s[i - 1], s[i]});
      walls.insert({s[i], s[i - 1]});
    }
  }
  std::map<Edge, std::size_t> face_at;
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) face_at[{model.faces[f][i], model.faces[f][(i + 1) % 3]}] = f;
  }
  std::vector<std::array<int, 3>> cut(model.faces.size(), {-1, -1, -1});
  const auto place = [&](std::size_t f, int knot) {
    return static_cast<std::size_t>(std::find(model.faces[f].begin(), model.faces[f].end(), knot) -
                                    model.faces[f].begin());
  };
  std::vector<std::vector<std::size_t>> faces_of(t.kind.size());
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    for (const int k : model.faces[f]) faces_of[static_cast<std::size_t>(k)].push_back(f);
  }
  for (int k = 0; k < static_cast<int>(t.kind.size()); ++k) {
    for (const std::size_t start : faces_of[static_cast<std::size_t>(k)]) {
      if (cut[start][place(start, k)] >= 0) continue;
      const int corner = static_cast<int>(model.knot_of_corner.size());
      model.knot_of_corner.push_back(k);
      // Flood over shared edges at k that are no walls.
      std::vector<std::size_t> todo{start};
      while (!todo.empty()) {
        const std::size_t f = todo.back();
        todo.pop_back();
        const std::size_t i = place(f, k);
        if (cut[f][i] >= 0) continue;
        cut[f][i] = corner;
        const int out = model.faces[f][(i + 1) % 3];
        const int in = model.faces[f][(i + 2) % 3];
        if (!walls.count({k, out}) && face_at.count({out, k})) todo.push_back(face_at[{out, k}]);
        if (!walls.count({k, in}) && face_at.count({k, in})) todo.push_back(face_at[{k, in}]);
      }
    }
  }
  return cut;
}

/// Multisets I + v in lexicographic order, each with the edges opposite v, opposite pairs taken out.
std::map<std::vector<int>, std::vector<Edge>> links(const Family& family) {
  std::map<std::vector<int>, std::map<Edge, int>> balance;
  for (const auto& c : family) {
    for (std::size_t i = 0; i < 3; ++i) {
      std::vector<int> j = c.inner;
      j.push_back(c.triangle[i]);
      std::sort(j.begin(), j.end());
      const int from = c.triangle[(i + 1) % 3];
      const int to = c.triangle[(i + 2) % 3];
      balance[j][std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  std::map<std::vector<int>, std::vector<Edge>> result;
  for (const auto& [j, edges] : balance) {
    auto& list = result[j];
    for (const auto& [e, n] : edges) {
      for (int i = 0; i < n; ++i) list.push_back(e);
      for (int i = 0; i < -n; ++i) list.push_back({e.second, e.first});
    }
  }
  return result;
}

void close_chains(const std::vector<int>& j, const std::vector<bool>& multiple, std::vector<Edge>& edges) {
  std::map<int, int> surplus;
  std::set<int> touched;
  for (const auto& [from, to] : edges) {
    ++surplus[from];
    --surplus[to];
    touched.insert(from);
    touched.insert(to);
  }
  std::vector<int> starts;
  std::vector<int> ends;
  for (const auto& [c, n] : surplus) {
    for (int i = 0; i < n; ++i) starts.push_back(c);
    for (int i = 0; i < -n; ++i) ends.push_back(c);
  }
  const auto m = std::find_if(
      j.begin(), j.end(), [&](int c) { return multiple[static_cast<std::size_t>(c)] && !touched.count(c); });
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (m == j.end()) {
      edges.push_back({ends[i], starts[i]});
    } else {
      edges.push_back({ends[i], *m});
      edges.push_back({*m, starts[i]});
    }
  }
}

std::vector<std::vector<int>> loops(std::vector<Edge> edges) {
  std::multiset<Edge> unused(edges.begin(), edges.end());
  std::vector<std::vector<int>> result;
  std::vector<int> path;
  while (!path.empty() || !unused.empty()) {
    if (path.empty()) path.push_back(unused.begin()->first);
    const auto edge = unused.lower_bound({path.back(), -1});
    require(edge != unused.end() && edge->first == path.back(), "an open link");
    const int next = edge->second;
    unused.erase(edge);
    const auto met = std::find(path.begin(), path.end(), next);
    if (met == path.end()) {
      path.push_back(next);
      continue;
    }
    std::vector<int> loop(met, path.end());
    path.erase(met, path.end());
    if (!path.empty()) path.push_back(next);
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    if (loop.size() >= 3) result.push_back(loop);
  }
  return result;
}

struct LinkCodes {
  Coded& in;
  std::array<Number, 8> by_span;
};

void triangulate(const std::vector<int>& loop, std::size_t i, std::size_t j, LinkCodes& codes,
                 const std::vector<int>& inner, Family& family) {
  if (j - i < 2) return;
  const std::size_t p =
      i + 1 +
      (j - i > 2 ? static_cast<std::size_t>(codes.by_span[std::min<std::size_t>(j - i - 3, 7)].read(codes.in))
                 : 0);
  family.push_back({{loop[i], loop[p], loop[j]}, inner});
  triangulate(loop, i, p, codes, inner, family);
  triangulate(loop, p, j, codes, inner, family);
}

void build_functions(Coded& in, const Topology& t, IndependentModel& model) {
  LinkCodes codes{in, {}};
  Family family;
  for (const auto& f : cut_open(t, model)) family.push_back({f, {}});
  std::vector<bool> multiple;
  for (const int k : model.knot_of_corner) {
    multiple.push_back(t.kind[static_cast<std::size_t>(k)] == Topology::kVertex);
  }
  for (int level = 0; level < model.degree - 1; ++level) {
    Family next;
    for (auto& link : links(family)) {
      const std::vector<int>& j = link.first;
      std::vector<Edge>& edges = link.second;
      close_chains(j, multiple, edges);
      for (std::vector<int>& loop : loops(edges)) {
        const auto copy = std::find_if(loop.begin(), loop.end(), [&](int c) {
          return multiple[static_cast<std::size_t>(c)] && std::find(j.begin(), j.end(), c) != j.end();
        });
        if (loop.size() > 3 && copy != loop.end()) {
          std::rotate(loop.begin(), copy, loop.end());
          for (std::size_t i = 1; i + 1 < loop.size(); ++i)
            next.push_back({{loop[0], loop[i], loop[i + 1]}, j});
        } else {
          triangulate(loop, 0, loop.size() - 1, codes, j, next);
        }
      }
    }
    family = next;
  }
  for (const auto& [j, edges] : links(family)) {
    if (!edges.empty()) model.functions.push_back(j);
  }
  model.configs = family;
}

// --- Section 8: control points, for a keyframe

class Means {
 public:
  std::vector<Integer> predict(const std::vector<int>& places, std::size_t size) {
    std::vector<Integer> sum(size, 0);
    Integer n = 0;
    for (const int p : places) {
      for (std::size_t i = 0; i < size; ++i) sum[i] += sums_[p].empty() ? 0 : sums_[p][i];
      n += counts_[p];
    }
    if (n == 0) return last_.empty() ? sum : last_;
    for (Integer& s : sum) s = floor_div(2 * s + n, 2 * n);
    return sum;
  }
  Around around(const std::vector<int>& places, std::size_t component) {
    Around result;
    for (const int p : places) result.add(differences_[{p, component}]);
    return result;
  }
  void add(const std::vector<int>& places, const std::vector<Integer>& v,
           const std::vector<Integer>& differences) {
    for (const int p : places) {
      for (std::size_t i = 0; i < v.size(); ++i) differences_[{p, i}].add(differences[i]);
      sums_[p].resize(v.size(), 0);
      for (std::size_t i = 0; i < v.size(); ++i) sums_[p][i] += v[i];
      ++counts_[p];
    }
    last_ = v;
  }

 private:
  std::map<int, std::vector<Integer>> sums_;
  std::map<int, Integer> counts_;
  std::map<std::pair<int, std::size_t>, Around> differences_;
  std::vector<Integer> last_;
};

void read_control(Coded& in, double displacement_step, double colour_step, Integer unit,
                  IndependentModel& model) {
  std::array<Difference, 2> displacements;
  const auto channels = static_cast<std::size_t>(model.channels);
  std::vector<Difference> colours(channels);

  std::map<std::vector<int>, std::vector<Integer>> groups;
  std::vector<std::vector<int>> group_of;
  for (const auto& j : model.functions) {
    std::vector<int> knots;
    for (const int c : j) knots.push_back(model.knot_of_corner[static_cast<std::size_t>(c)]);
    std::sort(knots.begin(), knots.end());
    groups[knots];
    group_of.push_back(knots);
  }
  Means displacement_means;
  for (auto& [knots, d] : groups) {
    d = displacement_means.predict(knots, 2);
    std::vector<Integer> differences;
    for (std::size_t i = 0; i < 2; ++i) {
      differences.push_back(displacements[i].read(in, displacement_means.around(knots, i)));
      d[i] += differences[i];
    }
    displacement_means.add(knots, d, differences);
  }
  Means colour_means;
  for (std::size_t f = 0; f < model.functions.size(); ++f) {
    std::vector<Integer> v = colour_means.predict(model.functions[f], channels);
    std::vector<Integer> differences(channels);
    std::vector<std::size_t> order;
    if (channels >= 3) order.push_back(1);
    for (std::size_t c = 0; c < channels; ++c) {
      if (channels < 3 || c != 1) order.push_back(c);
    }
    for (const std::size_t c : order) {
      if (channels >= 3 && (c == 0 || c == 2)) v[c] += unit * differences[1];
      differences[c] = colours[c].read(in, colour_means.around(model.functions[f], c));
      v[c] = unit * (floor_div(2 * v[c] + unit, 2 * unit) + differences[c]);
    }
    colour_means.add(model.functions[f], v, differences);

    Point greville{0, 0};
    for (const int c : model.functions[f]) {
      const Point p =
          model.knots[static_cast<std::size_t>(model.knot_of_corner[static_cast<std::size_t>(c)])];
      greville = {greville[0] + p[0], greville[1] + p[1]};
    }
    const auto& d = groups[group_of[f]];
    std::vector<double> control{greville[0] / model.degree + static_cast<double>(d[0]) * displacement_step,
                                greville[1] / model.degree + static_cast<double>(d[1]) * displacement_step};
    for (const Integer c : v) control.push_back(static_cast<double>(c) * colour_step);
    model.control.push_back(control);
  }
}

}  // namespace

std::vector<double> IndependentModel::surface(Point u) const {
  const auto at = [&](int corner) {
    return knots[static_cast<std::size_t>(knot_of_corner[static_cast<std::size_t>(corner)])];
  };
  std::map<std::vector<int>, double> basis;
  for (const Config& c : configs) {
    std::vector<Point> v;
    for (const int k : c.triangle) v.push_back(at(k));
    for (const int k : c.inner) v.push_back(at(k));
    const double m = plain_simplex_spline(u, v);
    if (m == 0) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      std::vector<int> j = c.inner;
      j.push_back(c.triangle[i]);
      std::sort(j.begin(), j.end());
      basis[j] += plain_area(u, v[(i + 1) % 3], v[(i + 2) % 3]) * m;
    }
  }
  std::vector<double> sum(control[0].size(), 0.0);
  for (std::size_t f = 0; f < functions.size(); ++f) {
    const auto b = basis.find(functions[f]);
    if (b == basis.end()) continue;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += b->second * control[f][i];
  }
  return sum;
}

IndependentModel read_independently(const std::vector<std::byte>& file) {
  std::vector<std::uint8_t> bytes;
  for (const std::byte b : file) bytes.push_back(std::to_integer<std::uint8_t>(b));

  // Section 2: container.
  const std::vector<std::uint8_t> magic{0x89, 'T', 'C', 'B', 0x0D, 0x0A, 0x1A, 0x0A};
  require(std::equal(magic.begin(), magic.end(), bytes.begin()), "magic");
  Input in{bytes, magic.size(), bytes.size()};
  require(in.fixed(4) == 3, "version");

  IndependentModel model;
  double colour_step = 0;
  double displacement_step = 0;
  while (true) {
    std::string type;
    for (int i = 0; i < 4; ++i) type += static_cast<char>(in.u8());
    const std::size_t length = in.fixed(4);
    in.fixed(8);  // checksums: the library's reader has verified them
    Input payload{bytes, in.at, in.at + length};
    in.at += length;
    if (type == "HEAD") {
      model.width = payload.count();
      model.height = payload.count();
      model.channels = payload.count();
      model.degree = payload.count();
      payload.varint();
      payload.varint();
      colour_step = static_cast<double>(payload.varint()) / 512;
      displacement_step = static_cast<double>(payload.varint()) / 4096;
    } else if (type == "FRAM") {
      const int flags = payload.u8();
      require(flags == 3 || flags == 11, "a keyframe");
      payload.varint();
      payload.varint();
      if (flags == 11) model.edge_softness = payload.u8() / 256.0;
      const int bits = payload.u8();
      const auto unit = static_cast<Integer>(payload.varint());
      Coded coded(payload);
      const Topology topology = read_topology(coded, model);
      read_positions(coded, bits, topology, model);
      build_functions(coded, topology, model);
      read_control(coded, displacement_step, colour_step, unit, model);
      return model;
    }
  }
}

}  // namespace knotreel::testing
