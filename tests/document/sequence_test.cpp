// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "document/bytes.h"
#include "document/container.h"
#include "document/frame_codec.h"
#include "document/reseal.h"
#include "document/sample_models.h"
#include "knotreel/base/error.h"
#include "knotreel/base/ticks.h"
#include "knotreel/document/reader.h"
#include "knotreel/document/writer.h"

namespace knotreel {
namespace {

using document::FrameModel;
using document::Reader;
using testing::difference;

constexpr std::uint64_t kSequenceSeed = 77;

struct Sequence {
  std::vector<FrameModel> stored;  ///< as append returned them
  std::vector<std::byte> bytes;
};

/// An encoder loop: every frame starts from what the writer returned. Frames 0 and 6 are keyframes; some keep
/// the topology, some swap knots, one changes nothing.
Sequence encode(int degree) {
  std::ostringstream out;
  FrameModel model =
      testing::random_model(testing::random_mesh(160, 120, 120, 3, kSequenceSeed), degree, 3, kSequenceSeed);
  document::EncodeOptions options;
  options.rename_knots = degree == 2;
  document::Writer writer(out, testing::info_of(model), options);
  Sequence sequence;
  for (std::uint64_t f = 0; f < 10; ++f) {
    sequence.stored.push_back(writer.append(model));
    const int swaps = f % 3 == 1 ? 4 : 0;
    model = testing::successor(sequence.stored.back(), swaps, kSequenceSeed + f);
    if (f == 2) {
      model = sequence.stored.back();
      model.keyframe = false;
      ++model.frame;
      ++model.pts;
    }
    model.keyframe = f + 1 == 6;
  }
  writer.finish();
  sequence.bytes = testing::bytes_of(out);
  return sequence;
}

TEST(Sequence, ReadsEveryFrameInAnyOrder) {
  for (int degree = 1; degree <= 3; ++degree) {
    const Sequence s = encode(degree);
    Reader reader = Reader::open(s.bytes);
    ASSERT_EQ(reader.frame_count(), s.stored.size());
    for (std::size_t f = 0; f < s.stored.size(); ++f)
      EXPECT_EQ(difference(reader.read(f), s.stored[f]), "") << f;
    std::mt19937_64 random(kSequenceSeed);
    for (int i = 0; i < 40; ++i) {
      const std::size_t f = random() % s.stored.size();
      EXPECT_EQ(difference(reader.read(f), s.stored[f]), "") << f;
      EXPECT_EQ(reader.record(f).keyframe, f == 0 || f == 6);
      EXPECT_EQ(reader.record(f).pts, s.stored[f].pts);
    }
  }
}

TEST(Sequence, KeepsItsBytesWhenReadAndWrittenAgain) {
  const Sequence s = encode(2);
  Reader reader = Reader::open(s.bytes);
  std::vector<FrameModel> frames;
  for (std::size_t f = 0; f < reader.frame_count(); ++f) frames.push_back(reader.read(f));
  document::EncodeOptions options;
  options.rename_knots = true;
  EXPECT_EQ(testing::write_document(frames, options), s.bytes);
}

TEST(Sequence, AFrameWithoutChangeCostsNextToNothing) {
  const Sequence s = encode(2);
  Reader reader = Reader::open(s.bytes);
  EXPECT_LE(reader.record(3).bytes, 24u);
  EXPECT_GT(reader.record(0).bytes, 1000u);
}

/// Where it alone changes, too.
TEST(Sequence, TheSoftnessOfEdgesStaysUntilItChanges) {
  FrameModel model =
      testing::random_model(testing::random_mesh(64, 48, 30, 1, kSequenceSeed), 2, 3, kSequenceSeed);
  const std::vector<double> softness{0.125, 0.125, 0, 0.25, 0.25, 0.25};
  std::ostringstream out;
  document::Writer writer(out, testing::info_of(model));
  for (std::size_t f = 0; f < softness.size(); ++f) {
    model.frame = f;
    model.pts = static_cast<std::int64_t>(f);
    model.keyframe = f == 0 || f == 5;
    model.edge_softness = softness[f];
    EXPECT_EQ(writer.append(model).edge_softness, softness[f]);
  }
  writer.finish();
  Reader reader = Reader::open(testing::bytes_of(out));
  for (std::size_t f = 0; f < softness.size(); ++f) EXPECT_EQ(reader.read(f).edge_softness, softness[f]) << f;
}

/// Such as no writer gives.
TEST(Sequence, TimesOutOfRangeAreRefused) {
  const auto index_with = [](std::int64_t pts) {
    return document::parse_index(document::write_index({{0, 16, 0, 0, true}, {16, 16, 1, pts, false}}));
  };
  EXPECT_EQ(index_with(kMaxTicks)[1].pts, kMaxTicks);
  const auto prefix_with = [](std::int64_t pts) {
    document::ByteWriter out;
    out.u8(4);
    out.varint(0);
    out.svarint(pts);
    return document::read_prefix(out.view()).pts;
  };
  EXPECT_EQ(prefix_with(-kMaxTicks), -kMaxTicks);
  const auto least = std::numeric_limits<std::int64_t>::min();
  for (const std::int64_t pts : {kMaxTicks + 1, -kMaxTicks - 1, least}) {
    EXPECT_THROW(index_with(pts), document::Malformed);
    EXPECT_THROW(prefix_with(pts), document::Malformed);
  }
}

TEST(Sequence, TimesAscend) {
  FrameModel model =
      testing::random_model(testing::random_mesh(64, 48, 30, 1, kSequenceSeed), 2, 3, kSequenceSeed);
  std::ostringstream out;
  document::Writer writer(out, testing::info_of(model));
  model.pts = 7;
  writer.append(model);
  const std::size_t size = out.str().size();
  model.keyframe = false;
  for (const std::int64_t pts : {7, 6, -1}) {
    model.pts = pts;
    EXPECT_THROW(writer.append(model), Error) << pts;
    EXPECT_EQ(out.str().size(), size);
  }
  model.pts = 8;
  EXPECT_EQ(writer.append(model).pts, 8) << "what was refused is without consequences";
}

/// Those of other programs: neither by the index nor, if the file is cut short, by the frames themselves.
TEST(Sequence, DocumentsWhoseTimesDoNotAscendAreRefused) {
  FrameModel model =
      testing::random_model(testing::random_mesh(64, 48, 30, 1, kSequenceSeed), 2, 3, kSequenceSeed);
  model.frame = 0;
  model.pts = 0;
  FrameModel later = model;
  later.keyframe = false;
  later.pts = 1;
  const std::vector<std::byte> good = testing::write_document({model, later});
  EXPECT_NO_THROW(Reader::open(good));
  const auto message_of = [](const std::vector<std::byte>& bytes) -> std::string {
    try {
      Reader::open(bytes);
      return "";
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kInput);
      return e.what();
    }
  };
  const document::FrameRecord record = Reader::open(good).record(1);
  std::vector<std::byte> bad = good;
  // Behind the flags and the number of the frame; and the last byte of the index.
  std::byte& in_frame = bad[static_cast<std::size_t>(record.offset) + document::kChunkHeaderBytes + 2];
  std::byte& in_index = bad[bad.size() - document::kEndChunkBytes - 1];
  ASSERT_EQ(in_frame, std::byte{2});
  ASSERT_EQ(in_index, std::byte{2});
  in_frame = in_index = std::byte{0};
  testing::reseal(bad);
  const std::string why = "the time of a frame is not after that of the frame before";
  EXPECT_NE(message_of(bad).find(why), std::string::npos) << message_of(bad);
  bad.resize(bad.size() - document::kEndChunkBytes);
  EXPECT_NE(message_of(bad).find(why), std::string::npos) << message_of(bad);
}

TEST(Sequence, NamesOfMetadataAscend) {
  document::Format format;
  format.info.width = format.info.height = format.info.channels = format.info.degree = 1;
  format.colour_step = format.displacement_step = 1;
  format.info.metadata = {{"a", ""}, {"b", ""}, {"\xC3\xBC", ""}};
  const std::vector<std::byte> good = document::write_header(format);
  EXPECT_EQ(document::parse_header(good).info.metadata, format.info.metadata);
  const auto a = std::find(good.begin(), good.end(), std::byte{'a'}) - good.begin();
  for (const char first : {'b', 'c'}) {
    std::vector<std::byte> bad = good;
    bad[static_cast<std::size_t>(a)] = static_cast<std::byte>(first);
    EXPECT_THROW(document::parse_header(bad), document::Malformed) << first;
  }
}

TEST(Sequence, ARepeatedKeyframeStaysAsItIs) {
  // Deltas have coarser steps, which are for frames that change.
  std::ostringstream out;
  FrameModel model =
      testing::random_model(testing::random_mesh(160, 120, 120, 3, kSequenceSeed), 2, 3, kSequenceSeed);
  document::Writer writer(out, testing::info_of(model));
  const FrameModel first = writer.append(model);
  for (std::uint64_t f = 1; f < 3; ++f) {
    FrameModel again = f == 1 ? first : model;  // as stored, or as it was given at first
    again.keyframe = false;
    again.frame = f;
    again.pts = first.pts + static_cast<std::int64_t>(f);
    const FrameModel stored = writer.append(again);
    EXPECT_TRUE(same_surface(stored, first)) << f;
  }
  FrameModel moved = first;
  moved.keyframe = false;
  moved.frame = 3;
  moved.pts = first.pts + 3;
  moved.colour[0] += 40;
  EXPECT_FALSE(same_surface(writer.append(moved), first));
  writer.finish();
  Reader reader = Reader::open(testing::bytes_of(out));
  const FrameModel read = reader.read(0);
  for (std::size_t f = 1; f < 3; ++f) {
    EXPECT_LE(reader.record(f).bytes, 24U) << f;
    EXPECT_TRUE(same_surface(reader.read(f), read)) << f;
  }
}

TEST(Sequence, FramesThatKeepTheTopologyAreSmall) {
  const Sequence s = encode(2);
  Reader reader = Reader::open(s.bytes);
  EXPECT_LT(reader.record(1).bytes, reader.record(0).bytes);
}

TEST(Sequence, ControlPointsKeepTheirNameWithTheirKnots) {
  const Sequence s = encode(2);
  using Name = std::multiset<mesh::KnotId>;
  std::map<std::uint32_t, Name> group;  // id -> knots, since the last keyframe
  std::size_t survivors = 0;
  for (const FrameModel& frame : s.stored) {
    if (frame.keyframe) group.clear();
    const std::size_t before = group.size();
    std::set<std::uint32_t> seen;
    const auto& space = *frame.space;
    for (std::size_t f = 0; f < space.function_count(); ++f) {
      Name name;
      for (int i = 0; i < space.degree(); ++i) {
        const auto corner = space.functions()[f].knots[static_cast<std::size_t>(i)];
        name.insert(space.mesh().knots[space.cut().corners[corner].knot].id);
      }
      EXPECT_TRUE(seen.insert(frame.function_ids[f]).second) << "ids are unique in a frame";
      const auto [it, fresh] = group.emplace(frame.function_ids[f], name);
      EXPECT_EQ(it->second, name);
      survivors += fresh ? 0 : 1;
    }
    if (before > 0) {
      EXPECT_LT(group.size(), before + space.function_count() / 2) << "most control points live on";
    }
  }
  EXPECT_GT(survivors, 1000u);
}

TEST(Sequence, SidesOfAFeatureKeepTheirNames) {
  // Swapped knots renumber the mesh; colours left and right of a feature must not change places.
  FrameModel model =
      testing::random_model(testing::random_mesh(160, 120, 120, 3, kSequenceSeed), 2, 1, kSequenceSeed);
  const auto paint = [](FrameModel& m) {
    // Colour by the side of the function's one-sided support: the mean of its corners' fans.
    for (std::uint32_t f = 0; f < m.space->function_count(); ++f) {
      Vec2 sum;
      double count = 0;
      for (const auto c : m.space->functions()[f].knots) {
        if (c == spline::kNoCorner) continue;
        for (const auto n : m.space->cut().fan(c)) {
          sum = sum + m.space->position(n);
          ++count;
        }
      }
      const Vec2 g = m.space->greville(f);
      m.colour[f] = sum.y / count > g.y ? 200 : 20;
    }
  };
  paint(model);
  std::ostringstream out;
  document::EncodeOptions options;
  options.delta_coarseness = 1;  // so that a colour stays what it is
  document::Writer writer(out, testing::info_of(model), options);
  FrameModel stored = writer.append(model);
  int on_features = 0;
  for (int step = 0; step < 8; ++step) {
    std::map<std::uint32_t, double> before;
    for (std::size_t f = 0; f < stored.function_ids.size(); ++f)
      before[stored.function_ids[f]] = stored.colour[f];
    FrameModel next = testing::successor(stored, 6, kSequenceSeed + static_cast<std::uint64_t>(step));
    paint(next);
    stored = writer.append(next);
    for (std::size_t f = 0; f < stored.function_ids.size(); ++f) {
      const auto& knots = stored.space->functions()[f].knots;
      const auto on_segment = [&](mesh::CornerIndex c) {
        return stored.space->mesh().knots[stored.space->cut().corners[c].knot].kind ==
               mesh::KnotKind::kSegment;
      };
      const auto it = before.find(stored.function_ids[f]);
      if (it == before.end() || !on_segment(knots[0]) || !on_segment(knots[1])) continue;
      ++on_features;
      EXPECT_EQ(it->second, stored.colour[f]);
    }
  }
  EXPECT_GT(on_features, 20);
}

}  // namespace
}  // namespace knotreel
