#include "engine/couplings/contact/contact_guard.h"

#include <algorithm>

#include "engine/kernels/contact/contact_response.h"
#include "engine/kernels/contact/straight_contact.h"

namespace truestep::contact {

namespace {

/// Rounds of stopping pairs before zones are formed.
constexpr int kStopRounds = 20;
/// How close a point may come to a triangle on its straight path, as a fraction of the touch distance.
constexpr double kNearest = 0.05;
/// m; a point this close to a triangle at the start is on neither side.
constexpr double kUndecided = 1e-13;

HullPath straight(const double* start, const double* end, size_t row) {
  const Vec3 x = load3(start, row);
  return {x, load3(end, row) - x, {}};
}

/// A point and a triangle on their straight paths.
struct StraightPair {
  HullPath p;
  std::array<HullPath, 3> c;

  StraightPair(const GuardedPoints& g, uint32_t point, uint32_t solid)
      : p(straight(g.start, g.points.x, point)) {
    const std::array<uint32_t, 3>& rows = g.solids.solids.triangles[solid];
    for (size_t k = 0; k < 3; ++k) c[k] = straight(g.other_start, g.other.x, rows[k]);
  }
  /// The distance at which the pair meets: reduced when it starts closer.
  double target(double reach) const {
    const std::array<Vec3, 3> at{c[0].x, c[1].x, c[2].x};
    const double d = norm(p.x - blend(at, nearest_on_hull(p.x, at, 3), 3));
    return d > kUndecided ? std::min(kNearest * reach, 0.25 * d) : 0;
  }
  std::optional<HullContact> meet(double reach) const {
    if (stays_clear(p, c, 2 * kNearest * reach)) return std::nullopt;
    const double near = target(reach);
    return near > 0 ? first_straight_contact(p, c, near) : std::nullopt;
  }
};

}  // namespace

bool PassGuard::run(const GuardedPoints& g, const ContactDef& law, NearPairs& near, Exchange& exchange,
                    const ThreadArena& arena) {
  moved_points_.assign(g.points.count, 0);
  moved_rows_.assign(g.other.count, 0);
  moved_solids_.assign(g.solids.solids.triangles.size(), 0);
  detect(g, near, Look::all, arena);
  if (hits_.empty()) return false;
  for (int round = 0; round < kStopRounds && !hits_.empty(); ++round) {
    for (const Touch& t : hits_) stop(g, law, t, exchange);
    detect(g, near, Look::changed, arena);
  }
  if (hits_.empty()) return true;
  zone_.resize(g.points.count + g.other.count);
  for (uint32_t row = 0; row < zone_.size(); ++row) zone_[row] = row;
  while (!hits_.empty() && join(g, exchange)) detect(g, near, Look::changed, arena);
  return true;
}

// Rows that end outside the pairs' boxes require new pairs; they started inside.
bool PassGuard::update_boxes(const GuardedPoints& g, NearPairs& near, Look look, const ThreadArena& arena) {
  const auto& triangles = g.solids.solids.triangles;
  const double d = 2 * kNearest * g.reach;
  bool held = true;
  for (size_t i = 0; i < g.points.count; ++i) {
    if (look == Look::changed && !moved_points_[i]) continue;
    const Vec3 end = load3(g.points.x, i);
    held &= near.holds_point(i, {end, end});
  }
  for (size_t i = 0; i < triangles.size(); ++i) {
    moved_solids_[i] = 0;
    for (const uint32_t row : triangles[i]) moved_solids_[i] |= moved_rows_[row];
    if (look == Look::changed && !moved_solids_[i]) continue;
    Box box = Box::nothing();
    for (const uint32_t row : triangles[i]) box.cover(load3(g.other.x, row));
    box.low -= Vec3{d, d, d}, box.high += Vec3{d, d, d};
    held &= near.holds_solid(i, box);
  }
  return held;
}

void PassGuard::detect(const GuardedPoints& g, NearPairs& near, Look look, const ThreadArena& arena) {
  const size_t triangles = g.solids.solids.triangles.size();
  if (!update_boxes(g, near, look, arena)) near.find(arena, [](uint32_t, uint32_t) { return true; });
  found_.resize(near.blocks());
  near.each_block(arena, [&](size_t block, const std::vector<NearPair>& pairs) {
    std::vector<Touch>& found = found_[block];
    found.clear();
    for (const NearPair& pair : pairs) {
      if (pair.solid >= triangles) continue;
      if (look == Look::changed && !moved_points_[pair.point] && !moved_solids_[pair.solid]) continue;
      if (const auto at = StraightPair(g, pair.point, pair.solid).meet(g.reach)) {
        found.push_back({at->s, pair.point, pair.solid});
      }
    }
  });
  hits_.clear();
  for (const auto& found : found_) hits_.insert(hits_.end(), found.begin(), found.end());
  std::sort(hits_.begin(), hits_.end(), touch_order);
  std::fill(moved_points_.begin(), moved_points_.end(), uint8_t{0});
  std::fill(moved_rows_.begin(), moved_rows_.end(), uint8_t{0});
}

// A pair that comes too close ends as far apart, along the direction of their meeting, as it began or as it
// touches.
bool PassGuard::stop(const GuardedPoints& g, const ContactDef& law, const Touch& t, Exchange& exchange) {
  const StraightPair ways(g, t.point, t.solid);
  const auto at = ways.meet(g.reach);
  if (!at) return false;
  const ContactPair c(g.points, g.other, t.point, g.solids.corners(t.solid), at->w);
  if (c.k == 0) return false;
  const Vec3 before = c.relative(g.start, g.other_start), after = c.relative(g.points.x, g.other.x);
  const double wanted = std::min(g.reach, std::max(dot(before, at->n), 4 * ways.target(g.reach)));
  const double missing = wanted - dot(after, at->n);
  const Vec3 u = c.relative(g.points.v, g.other.v);
  Vec3 jump;
  if (missing > 0) {
    c.change(g.points.x, g.other.x, at->n * missing);
    if (dot(u, at->n) < 0) jump = impact(u, at->n, 0.0, law.friction) - u;
  } else {
    // When a triangle turns under the point, the point follows the place that it met.
    c.change(g.points.x, g.other.x, before - after);
    jump = -u;
  }
  c.change(g.points.v, g.other.v, jump);
  exchange.add(jump / -c.k, -0.5 * dot(jump, u + u + jump) / c.k);
  moved_points_[t.point] = 1;
  for (size_t k = 0; k < c.corners.count; ++k) moved_rows_[c.corners.rows[k]] = 1;
  return true;
}

uint32_t PassGuard::zone_of(uint32_t row) {
  while (zone_[row] != row) row = zone_[row] = zone_[zone_[row]];
  return row;
}

// Everything that meets, directly or through others, moves on together: with its common momentum, or as its
// held rows do.
bool PassGuard::join(const GuardedPoints& g, Exchange& exchange) {
  const auto first_other = static_cast<uint32_t>(g.points.count);
  bool joined = false;
  for (const Touch& t : hits_) {
    for (const uint32_t row : g.solids.solids.triangles[t.solid]) {
      const uint32_t a = zone_of(t.point), b = zone_of(first_other + row);
      zone_[std::max(a, b)] = std::min(a, b);
      joined |= a != b;
    }
  }
  zones_.assign(zone_.size(), {});
  members_.clear();
  for (const Touch& t : hits_) zones_[zone_of(t.point)].mass = 1;
  for (uint32_t row = 0; row < zone_.size(); ++row) {
    if (zones_[zone_of(row)].mass > 0) members_.push_back(row);
  }
  for (const uint32_t row : members_) zones_[zone_of(row)].mass = 0;

  struct Row {
    const double* start;
    double *x, *v;
    size_t row;
    double w;
  };
  const auto look_up = [&](uint32_t row) -> Row {
    if (row < first_other) return {g.start, g.points.x, g.points.v, row, g.points.inverse_mass(row)};
    const size_t r = row - first_other;
    return {g.other_start, g.other.x, g.other.v, r, g.other.inverse_mass(r)};
  };
  for (const uint32_t row : members_) {
    const Row r = look_up(row);
    Zone& z = zones_[zone_of(row)];
    if (z.held) continue;
    const Vec3 shift = load3(r.x, r.row) - load3(r.start, r.row), v = load3(r.v, r.row);
    if (r.w == 0) {
      z = {1, shift, v, true};
    } else {
      z.mass += 1 / r.w, z.shift += shift / r.w, z.momentum += v / r.w;
    }
  }
  for (const uint32_t row : members_) {
    const Row r = look_up(row);
    if (r.w == 0) continue;
    const Zone& z = zones_[zone_of(row)];
    const Vec3 old = load3(r.v, r.row), v = z.momentum / z.mass;
    store3(r.x, r.row, load3(r.start, r.row) + z.shift / z.mass);
    store3(r.v, r.row, v);
    const double lost = 0.5 * (norm2(old) - norm2(v)) / r.w;
    if (row < first_other) {
      exchange.add((old - v) / r.w, lost);
      moved_points_[r.row] = 1;
    } else {
      exchange.energy_lost += lost;
      moved_rows_[r.row] = 1;
    }
  }
  return joined;
}

}  // namespace truestep::contact
