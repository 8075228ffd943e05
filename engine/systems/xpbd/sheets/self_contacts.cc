#include "engine/systems/xpbd/sheets/self_contacts.h"

#include <algorithm>
#include <numeric>

namespace truestep::xpbd {

namespace {

// Rounds of impulses, sweeps over the contacts in each, and rounds of rigid zones for what is left.
constexpr int kRounds = 3, kSweeps = 6, kMostZoneRounds = 50;
// At least this share of the gap remains or, if smaller, this share of the distance at the start.
constexpr double kLeast = 0.1, kKept = 0.9;
// s, time constant for separating what is too close: faster would make it hop.
constexpr double kApart = 0.05;
// Cosine of the hinge's turn beyond which the surface about it may meet itself.
constexpr double kFold = 0.5;
// Slack of boxes: least and most, in thicknesses; and in longest paths relative to the mean.
constexpr double kLeastSlack = 0.05, kMostSlack = 0.5, kSlackOfPath = 4;
// Sine of the angle by which a normal may lean over a triangle at its edge.
constexpr double kLean = 0.02;
constexpr size_t kBlockFacets = 512, kBlockPairs = 4096;

FeaturePoints gather(std::span<const double> x, const std::array<uint32_t, 4>& p) {
  return {load3(x.data(), p[0]), load3(x.data(), p[1]), load3(x.data(), p[2]), load3(x.data(), p[3])};
}

/// Whether other features are closer: the closest point of a triangle lies on its border, or the normal of an
/// edge leans over a triangle that it belongs to. Such contacts would catch sliding surfaces at every edge.
bool leans(const SelfSweep& sweep, const std::array<uint32_t, 4>& p, const std::array<uint32_t, 4>& across,
           double t, const Proximity& at) {
  if (p[1] == across[0]) return std::any_of(at.c.begin(), at.c.end(), [](double c) { return c == 0; });
  const auto place = [&](uint32_t i) {
    const Vec3 from = load3(sweep.x0.data(), i);
    return from + (load3(sweep.x1.data(), i) - from) * t;
  };
  for (size_t k = 0; k < 4; ++k) {
    if (across[k] == UINT32_MAX) continue;
    const size_t edge = k & 2;
    const Vec3 a = place(p[edge]), u = normalized(place(p[edge + 1]) - a), r = place(across[k]) - a;
    const Vec3 inward = r - u * dot(u, r);
    // The normal points from the second edge to the first.
    const double over = dot(at.normal, inward) * (edge == 0 ? -1 : 1);
    if (over > kLean * norm(inward)) return true;
  }
  return false;
}

}  // namespace

double SelfContacts::Search::reach() const {
  return round == Round::first ? options.thickness : kLeast * options.thickness;
}

void SelfContacts::begin_step(const FoldSurface& surface) {
  known_ = false;
  drift_ = {};
  const size_t points = surface.rest().size(), facets = surface.facets().size();
  reach_.resize(points), boxes_.resize(facets), normals_.resize(facets);
  if (tree_of_ != &surface) {
    tree_of_ = &surface;
    for (size_t f = 0; f < facets; ++f) {
      boxes_[f] = Box::nothing();
      for (const uint32_t p : surface.facets()[f].points) boxes_[f].cover(surface.rest()[p]);
    }
    tree_.build(boxes_);
  }
  folded_.resize(points), moved_.resize(points), zone_.resize(points), sums_.resize(4 * points);
}

void SelfContacts::follow(const FoldSurface& surface, const SelfOptions& options, const SelfSweep& sweep,
                          const ThreadArena& arena) {
  const size_t n = reach_.size();
  Vec3 mean;
  for (size_t i = 0; i < n; ++i) mean += load3(sweep.x1.data(), i) - load3(sweep.x0.data(), i);
  next_drift_ = drift_ + mean / static_cast<double>(n);
  const auto inside = [](const Box& b, const Vec3& p) {
    return (b.low.x <= p.x) & (b.low.y <= p.y) & (b.low.z <= p.z) & (p.x <= b.high.x) & (p.y <= b.high.y) &
           (p.z <= b.high.z);
  };
  bool all = known_;
  for (size_t i = 0; all && i < n; ++i) {
    all = inside(reach_[i], load3(sweep.x0.data(), i) - drift_) &&
          inside(reach_[i], load3(sweep.x1.data(), i) - next_drift_);
  }
  if (!all) {
    double path = 0;
    for (size_t i = 0; i < n; ++i) {
      path = std::max(path,
                      norm2(load3(sweep.x1.data(), i) - next_drift_ - (load3(sweep.x0.data(), i) - drift_)));
    }
    const double slack = std::clamp(kSlackOfPath * std::sqrt(path), kLeastSlack * options.thickness,
                                    kMostSlack * options.thickness);
    for (size_t i = 0; i < n; ++i) {
      Box b = Box::nothing();
      b.cover(load3(sweep.x0.data(), i) - drift_), b.cover(load3(sweep.x1.data(), i) - next_drift_);
      reach_[i] = b.grown(slack);
    }
    find_pairs(surface, 0.5 * options.thickness, arena);
    known_ = true;
  }
}

void SelfContacts::find_pairs(const FoldSurface& surface, double grow, const ThreadArena& arena) {
  const auto facets = surface.facets();
  for (size_t f = 0; f < facets.size(); ++f) {
    Box b = reach_[facets[f].points[0]];
    b.cover(reach_[facets[f].points[1]]), b.cover(reach_[facets[f].points[2]]);
    boxes_[f] = b.grown(grow);
  }
  tree_.refit(boxes_);
  found_.resize(std::max(found_.size(), facets.size() / kBlockFacets + 1));
  arena.for_blocks(facets.size(), kBlockFacets, [&](size_t begin, size_t end) {
    auto& out = found_[begin / kBlockFacets].pairs;
    out.clear();
    for (size_t f = begin; f < end; ++f) {
      const auto near = surface.near(f);
      tree_.overlapping(boxes_[f], [&](uint32_t g) {
        if (g > f && !std::ranges::binary_search(near, g)) out.push_back({static_cast<uint32_t>(f), g});
      });
    }
  });
  pairs_.clear();
  for (size_t b = 0; b * kBlockFacets < facets.size(); ++b) {
    pairs_.insert(pairs_.end(), found_[b].pairs.begin(), found_[b].pairs.end());
  }
}

void SelfContacts::mark_folds(const FoldSurface& surface, const SelfSweep& sweep) {
  const auto hinges = surface.hinges();
  // Links have no hinges and few neighbours.
  std::fill(folded_.begin(), folded_.end(), hinges.empty() ? 1 : 0);
  for (const auto& p : hinges) {
    const Vec3 at = load3(sweep.x1.data(), p[0]), e = load3(sweep.x1.data(), p[1]) - at;
    const Vec3 n0 = cross(e, load3(sweep.x1.data(), p[2]) - at),
               n1 = cross(load3(sweep.x1.data(), p[3]) - at, e);
    const double d = dot(n0, n1);
    if (d > 0 && d * d > kFold * kFold * norm2(n0) * norm2(n1)) continue;
    for (const uint32_t i : p) folded_[i] = 1;
  }
}

void SelfContacts::update_boxes(const Search& search, const ThreadArena& arena) {
  const auto facets = search.surface.facets();
  const double grow = 0.5 * search.reach();
  arena.for_blocks(facets.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      Box b = Box::nothing();
      for (size_t k = 0; k < facets[f].corners; ++k) {
        b.cover(load3(search.sweep.x0.data(), facets[f].points[k]));
        b.cover(load3(search.sweep.x1.data(), facets[f].points[k]));
      }
      boxes_[f] = b.grown(grow);
      if (facets[f].corners < 3) continue;
      const auto& p = facets[f].points;
      const Vec3 a = load3(search.sweep.x0.data(), p[0]);
      normals_[f] = normalized(
          cross(load3(search.sweep.x0.data(), p[1]) - a, load3(search.sweep.x0.data(), p[2]) - a), Vec3{});
    }
  });
}

bool SelfContacts::apart(const Search& search, const Facet& f, const Facet& g, const Vec3& n) const {
  const auto extent = [&](const Facet& of) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t k = 0; k < of.corners; ++k) {
      const double a = dot(n, load3(search.sweep.x0.data(), of.points[k])),
                   b = dot(n, load3(search.sweep.x1.data(), of.points[k]));
      low = std::min(low, std::min(a, b)), high = std::max(high, std::max(a, b));
    }
    return std::pair(low, high);
  };
  const auto [f_low, f_high] = extent(f);
  const auto [g_low, g_high] = extent(g);
  return std::max(g_low - f_high, f_low - g_high) > search.reach();
}

template <class Kind>
void SelfContacts::meet(const Search& search, const std::array<uint32_t, 4>& p,
                        const std::array<uint32_t, 4>& across, Kinship kinship,
                        std::vector<Contact>& out) const {
  if (search.round == Round::check && !(moved_[p[0]] | moved_[p[1]] | moved_[p[2]] | moved_[p[3]])) return;
  const FeaturePoints x0 = gather(search.sweep.x0, p);
  FeaturePoints dx = gather(search.sweep.x1, p);
  Box first = Box::nothing(), second = Box::nothing();
  for (size_t i = 0; i < 4; ++i) {
    Box& b = i < Kind::kFirst ? first : second;
    b.cover(x0[i]), b.cover(dx[i]);
    dx[i] -= x0[i];
  }
  const double thickness = search.options.thickness;
  if (!first.grown(search.reach()).overlaps(second)) return;
  const Proximity start = Kind::closest(x0);
  if (!(start.distance > 0)) return;
  double target = thickness;
  if (kinship == Kinship::near) {
    const auto& rest = search.surface.rest();
    target = std::min(target, 0.5 * Kind::closest({rest[p[0]], rest[p[1]], rest[p[2]], rest[p[3]]}).distance);
    if (!(target > 1e-9 * thickness)) return;
  }
  const double least = std::min(kLeast * target, kKept * start.distance);
  const auto hit = first_approach<Kind>(x0, dx, search.round == Round::first ? target : least, start);
  if (!hit) return;
  const bool aside = search.round == Round::first && leans(search.sweep, p, across, hit->t, hit->at);
  const double gap =
      aside ? kWatched
            : target - std::max(0.0, target - start.distance) * std::max(0.0, 1 - search.sweep.h / kApart);
  out.push_back({p, hit->at.c, hit->at.normal, gap});
}

void SelfContacts::meet_facets(const Search& search, uint32_t a, uint32_t b, Kinship kinship,
                               std::vector<Contact>& out) const {
  if (!boxes_[a].overlaps(boxes_[b])) return;
  const auto facets = search.surface.facets();
  const auto points_on = [&](const Facet& of, const Facet& on) {
    const auto& t = on.points;
    for (size_t k = 0; on.corners == 3 && k < 3; ++k) {
      const uint32_t p = of.points[k];
      if (!(of.own_points >> k & 1) || p == t[0] || p == t[1] || p == t[2]) continue;
      meet<PointTriangle>(search, {p, t[0], t[1], t[2]}, {t[0], t[1], t[2], t[0]}, kinship, out);
    }
  };
  const Facet &f = facets[a], &g = facets[b];
  if (f.corners == 3 && (apart(search, f, g, normals_[a]) || apart(search, f, g, normals_[b]))) return;
  points_on(f, g), points_on(g, f);
  const auto inner = [](const Facet& of, size_t k) {
    return of.corners == 3 ? of.points[(k + 2) % 3] : UINT32_MAX;
  };
  for (size_t i = 0; i < 3; ++i) {
    if (!(f.own_edges >> i & 1)) continue;
    const uint32_t p0 = f.points[i], p1 = f.points[(i + 1) % 3];
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t q0 = g.points[k], q1 = g.points[(k + 1) % 3];
      if (!(g.own_edges >> k & 1) || p0 == q0 || p0 == q1 || p1 == q0 || p1 == q1) continue;
      meet<SegmentSegment>(search, {p0, p1, q0, q1}, {inner(f, i), f.across[i], inner(g, k), g.across[k]},
                           kinship, out);
    }
  }
}

void SelfContacts::find_contacts(const Search& search, const ThreadArena& arena) {
  update_boxes(search, arena);
  const auto facets = search.surface.facets();
  const size_t near_blocks = (facets.size() + kBlockFacets - 1) / kBlockFacets,
               far_blocks = (pairs_.size() + kBlockPairs - 1) / kBlockPairs;
  found_.resize(std::max(found_.size(), near_blocks + far_blocks));
  arena.for_blocks(facets.size(), kBlockFacets, [&](size_t begin, size_t end) {
    auto& out = found_[begin / kBlockFacets].contacts;
    out.clear();
    const auto folds = [&](size_t f) {
      const auto& p = facets[f].points;
      return folded_[p[0]] | folded_[p[1]] | folded_[p[2]];
    };
    for (size_t f = begin; f < end; ++f) {
      const bool fold = folds(f);
      for (const uint32_t g : search.surface.near(f)) {
        if (fold || folds(g)) meet_facets(search, static_cast<uint32_t>(f), g, Kinship::near, out);
      }
    }
  });
  arena.for_blocks(pairs_.size(), kBlockPairs, [&](size_t begin, size_t end) {
    auto& out = found_[near_blocks + begin / kBlockPairs].contacts;
    out.clear();
    for (size_t k = begin; k < end; ++k) meet_facets(search, pairs_[k][0], pairs_[k][1], Kinship::far, out);
  });
  fresh_ = contacts_.size();
  for (size_t b = 0; b < near_blocks + far_blocks; ++b) {
    contacts_.insert(contacts_.end(), found_[b].contacts.begin(), found_[b].contacts.end());
  }
}

void SelfContacts::solve(const SelfOptions& options, const SelfSweep& s) {
  for (const Contact& c : contacts_) {
    for (const uint32_t p : c.points) moved_[p] = 1;
  }
  std::erase_if(contacts_, [](const Contact& c) { return c.gap == kWatched; });
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const Contact& c : contacts_) {
      const FeaturePoints x = gather(s.x1, c.points);
      double weight = 0;
      for (size_t i = 0; i < 4; ++i) weight += s.inverse_mass[c.points[i]] * c.c[i] * c.c[i];
      const Vec3 apart = x[0] * c.c[0] + x[1] * c.c[1] + x[2] * c.c[2] + x[3] * c.c[3];
      const double depth = c.gap - dot(c.normal, apart);
      if (!(depth > 0) || !(weight > 0)) continue;
      const FeaturePoints from = gather(s.x0, c.points);
      Vec3 slip = apart - (from[0] * c.c[0] + from[1] * c.c[1] + from[2] * c.c[2] + from[3] * c.c[3]);
      slip -= c.normal * dot(c.normal, slip);
      const double length = norm(slip), grip = options.friction * depth;
      const Vec3 by = (c.normal * depth - slip * (length > grip ? grip / length : 1.0)) / weight;
      for (size_t i = 0; i < 4; ++i) {
        const uint32_t p = c.points[i];
        if (!(s.inverse_mass[p] > 0)) continue;
        store3(s.x1.data(), p, x[i] + by * (s.inverse_mass[p] * c.c[i]));
      }
    }
  }
}

uint32_t SelfContacts::zone(uint32_t p) {
  while (zone_[p] != p) p = zone_[p] = zone_[zone_[p]];
  return p;
}

void SelfContacts::join_zones(const SelfSweep& s) {
  for (size_t k = fresh_; k < contacts_.size(); ++k) {
    uint32_t least = zone(contacts_[k].points[0]);
    for (const uint32_t p : contacts_[k].points) least = std::min(least, zone(p));
    for (const uint32_t p : contacts_[k].points) zone_[zone(p)] = least;
  }
  std::fill(sums_.begin(), sums_.end(), 0.0);
  const auto n = static_cast<uint32_t>(zone_.size());
  constexpr double kHeld = HUGE_VAL;
  for (uint32_t p = 0; p < n; ++p) {
    double* sum = sums_.data() + 4 * size_t{zone(p)};
    const double w = s.inverse_mass[p];
    if (!(w > 0)) {
      sum[0] = kHeld;
      continue;
    }
    const Vec3 d = (load3(s.x1.data(), p) - load3(s.x0.data(), p)) / w;
    sum[0] += 1 / w, sum[1] += d.x, sum[2] += d.y, sum[3] += d.z;
  }
  for (uint32_t p = 0; p < n; ++p) {
    const uint32_t z = zone(p);
    // A zone of one point has no contact.
    const double w = s.inverse_mass[p];
    const double* sum = sums_.data() + 4 * size_t{z};
    if (!(w > 0) || (z == p && sum[0] == 1 / w)) continue;
    const Vec3 shift = sum[0] < kHeld ? Vec3{sum[1], sum[2], sum[3]} / sum[0] : Vec3{};
    store3(s.x1.data(), p, load3(s.x0.data(), p) + shift);
    moved_[p] = 1;
  }
}

bool SelfContacts::search(const Search& what, const ThreadArena& arena) {
  follow(what.surface, what.options, what.sweep, arena);
  mark_folds(what.surface, what.sweep);
  find_contacts(what, arena);
  return fresh_ < contacts_.size();
}

bool SelfContacts::resolve(const FoldSurface& surface, const SelfOptions& options, const SelfSweep& sweep,
                           const ThreadArena& arena) {
  contacts_.clear();
  std::fill(moved_.begin(), moved_.end(), 0);
  bool met = search({surface, options, sweep, Round::first}, arena);
  for (int round = 0; met && round < kRounds; ++round) {
    solve(options, sweep);
    met = search({surface, options, sweep, Round::check}, arena);
  }
  if (met) std::iota(zone_.begin(), zone_.end(), 0u);
  for (int round = 0; met && round < kMostZoneRounds; ++round) {
    join_zones(sweep);
    met = search({surface, options, sweep, Round::check}, arena);
  }
  drift_ = next_drift_;
  return !contacts_.empty();
}

}  // namespace truestep::xpbd
