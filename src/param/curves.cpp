// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/curves.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "knotreel/base/error.h"
#include "param/border_ends.h"

namespace knotreel::param {
namespace {

/// Distance that feature pixels keep from the border of the domain, so that no triangle there is flat.
constexpr double kInset = 0.25;

[[noreturn]] void refuse(std::size_t chain, const char* what) {
  throw Error(ErrorKind::kInvalidArgument, "feature chain " + std::to_string(chain) + " " + what);
}

void check_shape(const features::FeatureChains& chains, std::size_t index) {
  const features::Chain& chain = chains.chains[index];
  if (chain.points.size() < (chain.closed ? 4U : 2U)) refuse(index, "has too few points");
  if (!chain.closed && (chain.first_node >= chains.node_count || chain.last_node >= chains.node_count)) {
    refuse(index, "ends at a node that does not exist");
  }
  const features::ChainPoint* before = chain.closed ? &chain.points.back() : nullptr;
  for (const features::ChainPoint& p : chain.points) {
    if (p.x < 0 || p.y < 0 || p.x >= chains.width || p.y >= chains.height)
      refuse(index, "leaves the picture");
    if (!std::isfinite(p.position.x) || !std::isfinite(p.position.y)) refuse(index, "has no position");
    if (before != nullptr) {
      const int step = std::max(std::abs(p.x - before->x), std::abs(p.y - before->y));
      if (step != 1) refuse(index, "has a step that is not to a neighbouring pixel");
    }
    before = &p;
  }
}

class CurveBuilder {
 public:
  explicit CurveBuilder(const features::FeatureChains& chains) : chains_(chains) {
    curves_.width = chains.width;
    curves_.height = chains.height;
    const std::size_t pixels =
        static_cast<std::size_t>(chains.width) * static_cast<std::size_t>(chains.height);
    curves_.at_pixel.assign(pixels, kNone);
    node_sites_.assign(chains.node_count, kNone);
    chains_at_.assign(chains.node_count, 0);
    extended_.assign(chains.node_count, false);
  }

  Curves build() {
    for (std::size_t i = 0; i < chains_.chains.size(); ++i) add(i);
    // Only now, with all pixels taken, is it known where a chain can go on to the border.
    for (std::size_t i = 0; i < chains_.chains.size(); ++i) {
      const features::Chain& chain = chains_.chains[i];
      if (chain.closed) continue;
      std::vector<SiteIndex>& sites = curves_.curves[i].sites;
      if (chain.last_on_border) extend(curves_.curves[i], chain.last_node);
      if (!chain.first_on_border) continue;
      std::reverse(sites.begin(), sites.end());
      extend(curves_.curves[i], chain.first_node);
      std::reverse(sites.begin(), sites.end());
    }
    for (std::uint32_t c = 0; c < curves_.curves.size(); ++c) number_sites(c);
    return std::move(curves_);
  }

 private:
  void add(std::size_t index) {
    check_shape(chains_, index);
    const features::Chain& chain = chains_.chains[index];
    Curve curve;
    curve.chain = static_cast<std::uint32_t>(index);
    curve.closed = chain.closed;
    curve.stepped = chain.stepped;
    curve.sites.reserve(chain.points.size() + 2);
    for (std::size_t i = 0; i < chain.points.size(); ++i) {
      std::uint32_t node = kNone;
      if (!chain.closed && i == 0) node = chain.first_node;
      if (!chain.closed && i + 1 == chain.points.size()) node = chain.last_node;
      curve.sites.push_back(site_of(index, chain.points[i], node));
    }
    if (!chain.closed) {
      ++chains_at_[chain.first_node];
      ++chains_at_[chain.last_node];
    }
    curves_.curves.push_back(std::move(curve));
  }

  /// Once per node. What was a tip is then an ordinary point: a vertex there would make a very short segment.
  void extend(Curve& curve, features::NodeIndex node) {
    if (extended_[node]) return;
    extended_[node] = continue_to_border(curves_, curve);
    if (extended_[node] && chains_at_[node] == 1) curves_.sites[node_sites_[node]].is_vertex = false;
  }

  SiteIndex site_of(std::size_t chain, const features::ChainPoint& p, std::uint32_t node) {
    SiteIndex& at = curves_.at_pixel[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(chains_.width) +
                                     static_cast<std::size_t>(p.x)];
    if (node == kNone ? at != kNone : at != node_sites_[node]) {
      refuse(chain, "shares a pixel that is not one of its nodes");
    }
    if (at != kNone) return at;
    at = static_cast<SiteIndex>(curves_.sites.size());
    if (node != kNone) node_sites_[node] = at;
    Site site;
    site.pixel = p.y * chains_.width + p.x;
    site.is_vertex = node != kNone || p.corner;
    site.preferred = p.preferred;
    site.beyond = p.beyond;
    site.centre = {p.x + 0.5, p.y + 0.5};
    // Further than one pixel per axis the chain's promise is broken; folds would be the least of it.
    const auto place = [](double centre, double curve, int size) {
      return std::clamp(std::clamp(curve, centre - 1, centre + 1), kInset, size - kInset);
    };
    site.faired = {place(site.centre.x, p.position.x, chains_.width),
                   place(site.centre.y, p.position.y, chains_.height)};
    site.position = site.faired;
    curves_.sites.push_back(site);
    return at;
  }

  /// Tells the sites inside a curve where they are. Ends and nodes belong to no single curve.
  void number_sites(std::uint32_t c) {
    const Curve& curve = curves_.curves[c];
    const std::size_t first = curve.closed ? 0 : 1;
    const std::size_t end = curve.closed ? curve.sites.size() : curve.sites.size() - 1;
    for (std::size_t i = first; i < end; ++i) {
      curves_.sites[curve.sites[i]].curve = c;
      curves_.sites[curve.sites[i]].index = static_cast<std::uint32_t>(i);
    }
  }

  const features::FeatureChains& chains_;
  Curves curves_;
  std::vector<SiteIndex> node_sites_;
  std::vector<int> chains_at_;  // per node
  std::vector<bool> extended_;  // per node
};

}  // namespace

Curves make_curves(const features::FeatureChains& chains) {
  return CurveBuilder(chains).build();
}

void set_fairing(Site& site, double fairing) {
  site.fairing = fairing;
  site.position = fairing == 0 ? site.centre : site.centre + fairing * (site.faired - site.centre);
}

bool relax(Site& site) {
  if (site.fairing == 0) return false;
  set_fairing(site, site.fairing > 0.2 ? 0.5 * site.fairing : 0.0);
  return true;
}

}  // namespace knotreel::param
