// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/uncross.h"

#include <algorithm>

#include "param/contacts.h"

namespace knotreel::param {
namespace {

struct Steps {
  std::vector<Piece> pieces;
  std::vector<std::uint32_t> curve;  ///< of each piece
};

Steps all_steps(const Curves& curves) {
  Steps steps;
  for (std::uint32_t c = 0; c < curves.curves.size(); ++c) {
    const Curve& curve = curves.curves[c];
    if (curve.dropped) continue;
    for (std::size_t i = 0; i < step_count(curve); ++i) {
      const SiteIndex a = curve.sites[i];
      const SiteIndex b = site_after(curve, i);
      steps.pieces.push_back({a, b, curves.sites[a].position, curves.sites[b].position});
      steps.curve.push_back(c);
    }
  }
  return steps;
}

}  // namespace

void drop(Curves& curves, std::uint32_t c) {
  Curve& curve = curves.curves[c];
  curve.dropped = true;
  for (const SiteIndex s : curve.sites) {
    const bool shared = s == curve.sites.front() || s == curve.sites.back();
    if (shared && !curve.closed) continue;
    if (curves.sites[s].pixel != kNoPixel)
      curves.at_pixel[static_cast<std::size_t>(curves.sites[s].pixel)] = kNone;
  }
  // Its ends stay features as long as another curve has them.
  for (const SiteIndex end : {curve.sites.front(), curve.sites.back()}) {
    const bool used = std::any_of(curves.curves.begin(), curves.curves.end(), [&](const Curve& other) {
      return !other.dropped && std::find(other.sites.begin(), other.sites.end(), end) != other.sites.end();
    });
    const std::int32_t pixel = curves.sites[end].pixel;
    if (!used && pixel != kNoPixel) curves.at_pixel[static_cast<std::size_t>(pixel)] = kNone;
  }
}

int uncross(Curves& curves) {
  int dropped = 0;
  while (true) {
    const Steps steps = all_steps(curves);
    const auto contacts = find_contacts(steps.pieces);
    if (contacts.empty()) return dropped;
    std::vector<SiteIndex> involved;
    for (const auto& [p, q] : contacts) {
      for (const std::uint32_t i : {p, q}) {
        involved.push_back(steps.pieces[i].from);
        involved.push_back(steps.pieces[i].to);
      }
    }
    std::sort(involved.begin(), involved.end());
    involved.erase(std::unique(involved.begin(), involved.end()), involved.end());
    bool moved = false;
    for (const SiteIndex s : involved) moved = relax(curves.sites[s]) || moved;
    if (moved) continue;
    // Chains of pixel centres that meet: the later one goes.
    drop(curves, steps.curve[contacts.front().second]);
    ++dropped;
  }
}

}  // namespace knotreel::param
