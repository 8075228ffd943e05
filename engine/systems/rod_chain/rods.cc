#include "engine/systems/rod_chain/rods.h"

#include <algorithm>

namespace truestep::rod_chain {

namespace {

Vec3 end_rate(const Chain& c, const Rod& r) {
  return r.v + cross(r.w, r.u) * c.half;
}
Vec3 start_rate(const Chain& c, const Rod& r) {
  return r.v - cross(r.w, r.u) * c.half;
}

}  // namespace

void gaps(const Chain& c, std::span<const Rod> rods, std::span<Vec3> out) {
  Vec3 before = c.anchor;
  for (size_t j = 0; j < rods.size(); ++j) {
    out[j] = (rods[j].x - rods[j].u * c.half) - before;
    before = rods[j].x + rods[j].u * c.half;
  }
}

void gap_rates(const Chain& c, std::span<const Rod> rods, std::span<Vec3> out) {
  Vec3 before;
  for (size_t j = 0; j < rods.size(); ++j) {
    out[j] = start_rate(c, rods[j]) - before;
    before = end_rate(c, rods[j]);
  }
}

void constraint_matrix(const Chain& c, std::span<const Rod> rods, BlockTridiagonal& a) {
  a.resize(rods.size());
  const double s = 1 / c.mass, t = c.half * c.half / c.inertia;
  for (size_t j = 0; j < rods.size(); ++j) {
    // A force at one end moves that end by 1/m + (a^2 / I) across the rod, the other by the difference.
    a.diagonal[j] = across(s, t, rods[j].u);
    if (j == 0) continue;
    const Block3 before = across(s, t, rods[j - 1].u), far = across(s, -t, rods[j - 1].u);
    for (int r = 0; r < 3; ++r) a.diagonal[j].row[r] += before.row[r], a.above[j].row[r] = far.row[r] * -1.0;
  }
  a.factor();
}

double largest_eigenvalue(const Chain& c) {
  // Two rods, each end contributing 1/m + a^2/I, and their far ends at most |1/m - a^2/I| (or 1/m, along the
  // rod).
  const double s = 1 / c.mass, t = c.half * c.half / c.inertia;
  return 2 * (s + t) + 2 * std::max(s, std::abs(s - t));
}

Change response(const Chain& c, std::span<const Rod> rods, std::span<const Vec3> force, size_t j) {
  const Vec3 at_start = force[j], at_end = j + 1 < rods.size() ? force[j + 1] * -1.0 : Vec3{};
  return {(at_start + at_end) / c.mass, cross(rods[j].u, at_end - at_start) * (c.half / c.inertia)};
}

Change pulled(const Chain& c, const Rod& rod, double along, const Vec3& force) {
  return {force / c.mass, cross(rod.u, force) * (along / c.inertia)};
}

namespace {
Vec3 hand_force(const Rod& r, const Hand& hand) {
  const Vec3 arm = r.u * hand.along;
  return hand.force - (r.x + arm - hand.target) * hand.stiffness - (r.v + cross(r.w, arm)) * hand.damping;
}
}  // namespace

Change hand_rates(const Chain& c, const Rod& rod, const Hand& hand) {
  return pulled(c, rod, hand.along, hand_force(rod, hand));
}

Change hand_step(const Chain& c, const Rod& rod, const Hand& hand, double h) {
  // Implicit Euler with the largest mobility of the point: across the rod.
  const double mobility = 1 / c.mass + hand.along * hand.along / c.inertia;
  const double yield = 1 + mobility * h * (h * hand.stiffness + hand.damping);
  return pulled(c, rod, hand.along, hand_force(rod, hand) * (h / yield));
}

double kinetic(const Chain& c, std::span<const Rod> rods) {
  double e = 0;
  for (const Rod& r : rods) e += 0.5 * c.mass * norm2(r.v) + 0.5 * c.inertia * norm2(r.w);
  return e;
}

double potential(const Chain& c, std::span<const Rod> rods) {
  double e = 0;
  for (const Rod& r : rods) e -= c.mass * dot(c.gravity, r.x - c.anchor);
  return e;
}

double stored(const Chain& c, std::span<const Rod> rods, double k) {
  double squares = 0;
  Vec3 before = c.anchor;
  for (const Rod& r : rods) {
    squares += norm2((r.x - r.u * c.half) - before);
    before = r.x + r.u * c.half;
  }
  return 0.5 * k * squares;
}

double largest_gap(const Chain& c, std::span<const Rod> rods) {
  double most = 0;
  Vec3 before = c.anchor;
  for (const Rod& r : rods) {
    most = std::max(most, norm((r.x - r.u * c.half) - before));
    before = r.x + r.u * c.half;
  }
  return most;
}

}  // namespace truestep::rod_chain
