// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/pipeline/copy_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/base/ticks.h"
#include "knotreel/document/copier.h"
#include "knotreel/pipeline/sequence.h"

namespace knotreel::pipeline {
namespace {

using video::Rational;

/// Largest numerator and denominator of a frame rate that is read again.
constexpr std::int64_t kMostOfRate = 0x7fffffff;

/// Names of metadata without which pictures would be shown otherwise.
constexpr const char* kShape[] = {"display_matrix", "sample_aspect"};

std::string value_of(const document::SequenceInfo& info, const char* key) {
  const auto found = info.metadata.find(key);
  return found == info.metadata.end() ? std::string() : found->second;
}

void require_alike(const Contents& document, const Contents& first) {
  const auto require = [&](bool holds, const std::string& what) {
    if (holds) return;
    throw Error(ErrorKind::kInvalidArgument,
                "'" + document.name + "' and '" + first.name + "' cannot be one document: " + what);
  };
  const document::SequenceInfo& a = document.info;
  const document::SequenceInfo& b = first.info;
  const auto size = [](const document::SequenceInfo& info) {
    return std::to_string(info.width) + "x" + std::to_string(info.height);
  };
  require(a.width == b.width && a.height == b.height, "their sizes are " + size(a) + " and " + size(b));
  require(a.channels == b.channels,
          "they have " + std::to_string(a.channels) + " and " + std::to_string(b.channels) + " channels");
  require(a.degree == b.degree,
          "their degrees are " + std::to_string(a.degree) + " and " + std::to_string(b.degree));
  for (const char* key : kShape) {
    require(value_of(a, key) == value_of(b, key), std::string("they have different metadata '") + key + "'");
  }
}

/// The longest unit of time that both are whole multiples of.
/// @throws Error{kInvalidArgument} if no document can have it.
Rational common_base(Rational a, Rational b) {
  constexpr std::int64_t kMost = 0x7fffffff;
  const std::int64_t num = std::gcd(a.num * b.den, b.num * a.den);
  // Of (a.num / a.den, b.num / b.den) over the product of the denominators, which is below 2^62.
  const std::int64_t den = a.den * b.den;
  const std::int64_t factor = std::gcd(num, den);
  const Rational base{num / factor, den / factor};
  if (base.num > kMost || base.den > kMost) {
    throw Error(ErrorKind::kInvalidArgument,
                "the documents cannot be one: their units of time have no common one");
  }
  return base;
}

Rational base_of(const document::SequenceInfo& info) {
  return {info.time_base_num, info.time_base_den};
}

/// How many units `fine` are one of `coarse`, which is a multiple of it.
std::int64_t units_in(Rational coarse, Rational fine) {
  return coarse.num * fine.den / (coarse.den * fine.num);
}

std::int64_t checked_time(std::int64_t ticks) {
  if (is_time(ticks)) return ticks;
  throw Error(ErrorKind::kInvalidArgument, "the documents cannot be one: their times are too large");
}

/// A time or duration in units of which `factor` are one of its own.
std::int64_t in_units(std::int64_t ticks, std::int64_t factor) {
  return checked_time(std::abs(ticks) > kMaxTicks / factor ? kMaxTicks + 1 : ticks * factor);
}

/// What all say alike. Where they do not, nobody is right.
void keep_common_metadata(document::SequenceInfo& info, const Contents& other) {
  std::erase_if(info.metadata, [&](const auto& entry) {
    return entry.first != "colour_tags" && value_of(other.info, entry.first.c_str()) != entry.second;
  });
}

class Planner {
 public:
  Planner(const std::vector<Contents>& documents, Rational rate) : documents_(documents) {
    const Contents& first = documents.front();
    plan_.info = first.info;
    plan_.steps = first.steps;
    Rational base = base_of(first.info);
    for (const Contents& document : documents) {
      require_alike(document, first);
      plan_.steps = document::common_steps(plan_.steps, document.steps);
      base = common_base(base, base_of(document.info));
      keep_common_metadata(plan_.info, document);
    }
    const auto lasts_as_rate_says = [](const Contents& document) { return document.last_duration <= 0; };
    if (documents.size() > 1 && std::ranges::any_of(documents, lasts_as_rate_says)) {
      const Rational frame{rate.den, rate.num};
      base = common_base(base, frame);
      frame_ = units_in(frame, base);
    }
    plan_.info.time_base_num = base.num;
    plan_.info.time_base_den = base.den;
  }

  CopyPlan run() {
    for (std::size_t d = 0; d < documents_.size(); ++d) add(d);
    if (documents_.size() > 1) {
      const std::int64_t start = stream_info(documents_.front().info).start;
      plan_.info.metadata.erase("start");
      if (start != 0) plan_.info.metadata["start"] = std::to_string(in_units(start, factor_of(0)));
      plan_.info.metadata["end"] = std::to_string(plan_.end);
      tell_rate();
      warn_of_colours();
    }
    return std::move(plan_);
  }

 private:
  /// Units of time of the copy in one of a document.
  std::int64_t factor_of(std::size_t d) const {
    return units_in(base_of(documents_[d].info), base_of(plan_.info));
  }

  void add(std::size_t d) {
    const Contents& document = documents_[d];
    const std::int64_t factor = factor_of(d);
    const std::int64_t begin = in_units(document.times.front(), factor);
    const bool goes_on =
        d == 0 || (document.info == documents_[d - 1].info && begin > plan_.frames.back().pts);
    const std::int64_t shift = goes_on ? 0 : plan_.end - begin;
    for (std::size_t f = 0; f < document.times.size(); ++f) {
      plan_.frames.push_back({d, f, checked_time(in_units(document.times[f], factor) + shift)});
    }
    const std::int64_t last = document.last_duration > 0 ? in_units(document.last_duration, factor) : frame_;
    plan_.end = checked_time(plan_.frames.back().pts + last);
  }

  /// If the documents do not say one alike, and all frames last as long.
  void tell_rate() {
    if (plan_.info.metadata.contains("frame_rate")) return;
    const std::int64_t duration = plan_.end - plan_.frames.back().pts;
    for (std::size_t i = 1; i < plan_.frames.size(); ++i) {
      if (plan_.frames[i].pts - plan_.frames[i - 1].pts != duration) return;
    }
    const std::int64_t factor = std::gcd(plan_.info.time_base_den, duration);
    const std::int64_t num = plan_.info.time_base_den / factor;
    const std::int64_t ticks = duration / factor, unit = plan_.info.time_base_num;
    if (ticks > kMostOfRate / unit) return;
    plan_.info.metadata["frame_rate"] = std::to_string(num) + "/" + std::to_string(ticks * unit);
  }

  void warn_of_colours() {
    const auto other = std::ranges::find_if(documents_, [&](const Contents& document) {
      return value_of(document.info, "colour_tags") != value_of(plan_.info, "colour_tags");
    });
    if (other == documents_.end()) return;
    plan_.warnings.push_back("'" + other->name + "' has other colour tags than '" + documents_.front().name +
                             "', whose are kept: its colours may look different");
  }

  const std::vector<Contents>& documents_;
  std::int64_t frame_ = 0;  ///< duration of a frame that has none
  CopyPlan plan_;
};

}  // namespace

Contents contents_of(const document::Reader& reader, std::string name) {
  Contents contents{std::move(name), reader.info(), reader.steps(), {}, last_duration(reader)};
  contents.times.reserve(reader.frame_count());
  for (std::size_t i = 0; i < reader.frame_count(); ++i) contents.times.push_back(reader.record(i).pts);
  return contents;
}

CopyPlan plan_copy(const std::vector<Contents>& documents, video::Rational rate) {
  return Planner(documents, rate).run();
}

CopyPlan part_of(CopyPlan plan, std::size_t first, std::size_t last) {
  const bool all = first == 0 && last + 1 == plan.frames.size();
  if (all) return plan;
  if (last + 1 < plan.frames.size()) plan.end = plan.frames[last + 1].pts;
  plan.frames.resize(last + 1);
  plan.frames.erase(plan.frames.begin(), plan.frames.begin() + std::ptrdiff_t(first));
  if (first > 0) {
    const std::int64_t shift = plan.frames.front().pts;
    for (CopiedFrame& frame : plan.frames) frame.pts -= shift;
    plan.end -= shift;
    plan.info.metadata.erase("start");
  }
  plan.info.metadata["end"] = std::to_string(plan.end);
  return plan;
}

}  // namespace knotreel::pipeline
