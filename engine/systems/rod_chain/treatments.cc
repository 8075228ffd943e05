#include "engine/systems/rod_chain/treatments.h"

#include <algorithm>

#include "engine/base/interrupt.h"
#include "engine/math/trig.h"

namespace truestep::rod_chain {
namespace {

constexpr int kMostIterations = 20;

double largest(std::span<const Vec3> v) {
  double most = 0;
  for (const Vec3& x : v) most = std::max(most, norm2(x));
  return std::sqrt(most);
}

/// Newton's method on C = 0 with mass-weighted corrections; stops at the tolerance or when there is no
/// improvement. Returns the widest remaining gap (m).
double project_places(const Chain& c, std::span<Rod> rods, double tolerance, Scratch& s) {
  double last = HUGE_VAL;
  for (int k = 0; k < kMostIterations; ++k) {
    gaps(c, rods, s.force);
    const double gap = largest(s.force);
    if (gap <= tolerance || gap >= last) return gap;
    last = gap;
    constraint_matrix(c, rods, s.matrix);
    for (Vec3& f : s.force) f = -f;
    s.matrix.solve(s.force);
    std::copy(rods.begin(), rods.end(), s.from.begin());
    for (size_t j = 0; j < rods.size(); ++j) {
      const Change d = response(c, s.from, s.force, j);
      rods[j].x += d.v, rods[j].u = normalized(turned(rods[j].u, d.w));
    }
  }
  gaps(c, rods, s.force);
  return largest(s.force);
}

void sum_pulls(const Chain& c, std::span<const Rod> rods, Scratch& s) {
  s.pulls.assign(rods.size(), {});
  for (const Hand& hand : c.hands) {
    const Change d = hand_rates(c, rods[hand.rod], hand);
    s.pulls[hand.rod].v += d.v, s.pulls[hand.rod].w += d.w;
  }
}

/// Hands in semi-implicit steps of h.
void take_hands(const Chain& c, std::span<Rod> rods, double h) {
  for (const Hand& hand : c.hands) {
    Rod& r = rods[hand.rod];
    const Change d = hand_step(c, r, hand, h);
    r.v += d.v, r.w += d.w;
  }
}

/// Rates of change of the whole state, with the exact joint forces.
void lagrange_rates(const Chain& c, std::span<const Rod> rods, std::span<Rod> rates, Scratch& s) {
  // C'' = J M^-1 f + J' v + (J M^-1 J^T) F = 0. Gravity accelerates all rods equally: only the anchor resists
  // it.
  Vec3 before;
  for (size_t j = 0; j < rods.size(); ++j) {
    const Vec3 inward = cross(rods[j].w, cross(rods[j].w, rods[j].u)) * c.half;
    s.force[j] = inward + before - (j == 0 ? c.gravity : Vec3{});
    before = inward;
  }
  if (!c.hands.empty()) {
    sum_pulls(c, rods, s);
    Vec3 end;  // acceleration of the previous rod's end by hands
    for (size_t j = 0; j < rods.size(); ++j) {
      const Vec3 turning = cross(s.pulls[j].w, rods[j].u) * c.half;
      s.force[j] -= s.pulls[j].v - turning - end;
      end = s.pulls[j].v + turning;
    }
  }
  constraint_matrix(c, rods, s.matrix);
  s.matrix.solve(s.force);
  for (size_t j = 0; j < rods.size(); ++j) {
    const Change d = response(c, rods, s.force, j);
    rates[j] = {rods[j].v, cross(rods[j].w, rods[j].u), c.gravity + d.v, d.w};
  }
  for (size_t j = 0; j < rods.size() && !c.hands.empty(); ++j) {
    rates[j].v += s.pulls[j].v, rates[j].w += s.pulls[j].w;
  }
}

void add(std::span<const Rod> from, std::span<const Rod> rates, double h, std::span<Rod> out) {
  for (size_t j = 0; j < from.size(); ++j) {
    const Rod &a = from[j], &d = rates[j];
    out[j] = {a.x + d.x * h, a.u + d.u * h, a.v + d.v * h, a.w + d.w * h};
  }
}

}  // namespace

void RodEquations::write(std::span<const Rod> rods, double* y) {
  for (size_t j = 0; j < rods.size(); ++j) {
    const Vec3* part[] = {&rods[j].x, &rods[j].u, &rods[j].v, &rods[j].w};
    for (size_t k = 0; k < 4; ++k) store3(y, 4 * j + k, *part[k]);
  }
}
void RodEquations::read(const double* y, std::span<Rod> rods) {
  for (size_t j = 0; j < rods.size(); ++j)
    rods[j] = {load3(y, 4 * j), load3(y, 4 * j + 1), load3(y, 4 * j + 2), load3(y, 4 * j + 3)};
}
void RodEquations::rate(double, const double* y, double* dydt) const {
  interruption_point();
  Scratch& s = scratch_;
  s.force.resize(rods_), s.stage.resize(rods_), s.rates.resize(rods_);
  read(y, s.stage);
  lagrange_rates(chain_, s.stage, s.rates, s);
  write(s.rates, dydt);
}

void step_penalty(const Chain& chain, std::span<Rod> rods, double h, double k, double c, Scratch& s) {
  const size_t n = rods.size();
  s.force.resize(n), s.from.resize(n);
  const auto drift = [&](double time) {
    for (Rod& r : rods) r.x += r.v * time, r.u = normalized(turned(r.u, r.w * time));
  };
  drift(0.5 * h);
  gap_rates(chain, rods, s.force);
  for (Vec3& f : s.force) f = f * -c;
  Vec3 before = chain.anchor;
  for (size_t j = 0; j < n; ++j) {
    s.force[j] -= ((rods[j].x - rods[j].u * chain.half) - before) * k;
    before = rods[j].x + rods[j].u * chain.half;
  }
  for (size_t j = 0; j < n; ++j) {
    const Change d = response(chain, rods, s.force, j);
    rods[j].v += (chain.gravity + d.v) * h, rods[j].w += d.w * h;
  }
  take_hands(chain, rods, h);
  drift(0.5 * h);
}

bool step_projection(const Chain& chain, std::span<Rod> rods, double h, double tolerance, Scratch& s) {
  const size_t n = rods.size();
  s.force.resize(n), s.from.resize(n), s.stage.assign(rods.begin(), rods.end());
  for (Rod& r : rods) r.v += chain.gravity * h;
  take_hands(chain, rods, h);
  for (Rod& r : rods) r.x += r.v * h, r.u = normalized(turned(r.u, r.w * h));
  constexpr double kClosed = 1e-9;  // of a rod: far above rounding, far below anything visible
  if (!(project_places(chain, rods, tolerance, s) <= std::max(tolerance, kClosed * chain.half))) {
    std::copy(s.stage.begin(), s.stage.end(), rods.begin());
    return false;
  }
  for (size_t j = 0; j < n; ++j) {
    const Rod& old = s.stage[j];
    rods[j].v = (rods[j].x - old.x) / h;
    const Vec3 axis = cross(old.u, rods[j].u);
    const double sine = norm(axis);
    rods[j].w = sine > 0 ? axis * (trig::atan2(sine, dot(old.u, rods[j].u)) / (sine * h)) : Vec3{};
  }
  return true;
}

void step_lagrange(const Chain& chain, std::span<Rod> rods, double h, double tolerance, Scratch& s) {
  const size_t n = rods.size();
  s.force.resize(n), s.from.resize(n), s.stage.resize(n), s.rates.resize(n);
  s.sum.assign(rods.begin(), rods.end());
  constexpr double kAhead[] = {0.5, 0.5, 1}, kShare[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  std::copy(rods.begin(), rods.end(), s.stage.begin());
  for (int stage = 0; stage < 4; ++stage) {
    lagrange_rates(chain, s.stage, s.rates, s);
    add(s.sum, s.rates, kShare[stage] * h, s.sum);
    if (stage < 3) add(rods, s.rates, kAhead[stage] * h, s.stage);
  }
  std::copy(s.sum.begin(), s.sum.end(), rods.begin());
  close_gaps(chain, rods, tolerance, s);
}

void close_rates(const Chain& chain, std::span<Rod> rods, Scratch& s) {
  s.force.resize(rods.size());
  gap_rates(chain, rods, s.force);
  for (Vec3& f : s.force) f = -f;
  constraint_matrix(chain, rods, s.matrix);
  s.matrix.solve(s.force);
  for (size_t j = 0; j < rods.size(); ++j) {
    const Change d = response(chain, rods, s.force, j);
    rods[j].v += d.v, rods[j].w += d.w;
  }
}

void close_gaps(const Chain& chain, std::span<Rod> rods, double tolerance, Scratch& s) {
  s.force.resize(rods.size()), s.from.resize(rods.size());
  for (Rod& r : rods) {
    r.u = normalized(r.u);
    r.w -= r.u * dot(r.u, r.w);
  }
  project_places(chain, rods, tolerance, s);
  close_rates(chain, rods, s);
}

}  // namespace truestep::rod_chain
