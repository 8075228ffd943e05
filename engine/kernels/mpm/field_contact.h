// Two bodies at a node of the grid, each with a velocity of its own (Bardenhagen, Guilkey, Roessig,
// Brackbill, Witzel, Foster 2001): the normal between them, the gap between their surfaces, and the contact
// impulse.
//   normal   logistic regression of the particles around the node (Nairn, Hammerquist, Smith 2020): the plane
//            n.x + d = 0 with the least  sum_j w_j ln(1 + exp(-s_j (n.x_j + d))) + lambda |n|^2 / 2,
//            s_j = -1 or 1 for the bodies, w_j = 1 / (particles of that body), lengths in cells
//   contact  where they come closer than the gap allows in the step; Coulomb's law along the surface
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "engine/kernels/mpm/laws.h"
#include "engine/math/solvers/small_lu.h"
#include "engine/math/vec3.h"

namespace truestep::mpm {

/// Particles around a node: places in cells from it (z is 0 in the plane), and which body each belongs to: -1
/// or 1; 0 fills up the last eight. As many of each, a multiple of eight, aligned to 32 bytes.
struct Cloud {
  std::span<const float> x, y, z, side;
};

namespace field_contact_detail {

inline double lanes_sum(Wide<float> a) {
  double sum = 0;
  for (int i = 0; i < Wide<float>::kLanes; ++i) sum += double{a[i]};
  return sum;
}
inline Wide<float> load8(const float* p) {
  Wide<float> out;
  std::memcpy(&out.v, p, sizeof out.v);
  return out;
}

/// The loss, its gradient and second derivatives by (n, d).
struct Loss {
  double value = 0, slope[4] = {}, bend[10] = {};
};

inline Loss loss_of(const Cloud& c, const double* plane, float weight_a, float weight_b, double penalty) {
  using W = Wide<float>;
  const W one(1), zero = W::zero(), most(30);
  const W n[4] = {W(plane[0]), W(plane[1]), W(plane[2]), W(plane[3])};
  W value = zero, slope[4] = {zero, zero, zero, zero}, bend[10];
  for (W& b : bend) b = zero;
  for (size_t k = 0; k < c.x.size(); k += W::kLanes) {
    const W at[4] = {load8(&c.x[k]), load8(&c.y[k]), load8(&c.z[k]), one}, side = load8(&c.side[k]);
    const W weight = select(side > zero, W(weight_b), select(side < zero, W(weight_a), zero));
    const W plain = side * madd(n[0], at[0], madd(n[1], at[1], madd(n[2], at[2], n[3])));
    const W margin = min(max(plain, -most), most);
    const W e = exp(-margin), share = e / (one + e);
    value = madd(weight, log(one + e), value);
    const W pull = weight * share * side, stiff = weight * share * (one - share);
    int b = 0;
    for (int i = 0; i < 4; ++i) {
      slope[i] -= pull * at[i];
      for (int j = i; j < 4; ++j, ++b) bend[b] = madd(stiff * at[i], at[j], bend[b]);
    }
  }
  Loss out;
  out.value = lanes_sum(value);
  for (int i = 0; i < 4; ++i) out.slope[i] = lanes_sum(slope[i]);
  for (int b = 0; b < 10; ++b) out.bend[b] = lanes_sum(bend[b]);
  for (int i = 0, b = 0; i < 3; b += 4 - i, ++i) {
    out.value += 0.5 * penalty * plane[i] * plane[i];
    out.slope[i] += penalty * plane[i], out.bend[b] += penalty;
  }
  return out;
}

}  // namespace field_contact_detail

/// Unit normal of the plane between the bodies of a cloud, from -1 to 1; zero if there is none (one body
/// alone, or both at the same positions).
inline Vec3 normal_between(const Cloud& c) {
  using namespace field_contact_detail;
  // At this penalty, particles a quarter of a cell behind the foremost ones hardly count; a larger one would
  // tilt the plane at corners (by 18 degrees at 1e-2, 5 here), a smaller one would leave it to single
  // particles.
  constexpr double kPenalty = 1e-4, kEnough = 1e-2;
  constexpr int kSteps = 24;
  int many_a = 0, many_b = 0;
  for (const float s : c.side) (s < 0 ? many_a : many_b) += s != 0;
  if (many_a == 0 || many_b == 0) return {};
  const float a = 1 / static_cast<float>(many_a), b = 1 / static_cast<float>(many_b);
  double plane[4] = {}, step[4] = {}, least = HUGE_VAL;
  for (int k = 0; k < kSteps; ++k) {
    const Loss now = loss_of(c, plane, a, b, kPenalty);
    if (!(now.value <= least * (1 + 1e-6))) {
      // Too far: half of the step is taken back.
      for (int i = 0; i < 4; ++i) step[i] *= 0.5, plane[i] -= step[i];
      continue;
    }
    least = now.value;
    SmallLu<double, 4> lu;
    for (int i = 0, q = 0; i < 4; ++i) {
      for (int j = i; j < 4; ++j, ++q) lu.matrix()[4 * j + i] = lu.matrix()[4 * i + j] = now.bend[q];
    }
    // If every particle is far from the plane, nothing determines its distance.
    lu.matrix()[15] += 1e-6;
    if (!lu.factor()) break;
    for (int i = 0; i < 4; ++i) step[i] = -now.slope[i];
    lu.solve(step);
    double size = 0, change = 0;
    for (int i = 0; i < 4; ++i) plane[i] += step[i], size += plane[i] * plane[i], change += step[i] * step[i];
    if (change <= kEnough * kEnough * size) break;
  }
  const Vec3 n{plane[0], plane[1], plane[2]};
  const double length = norm(n);
  return length > 1e-6 && length < HUGE_VAL ? n / length : Vec3{};
}

/// A body's share of a node.
struct FieldNode {
  double mass = 0;  ///< kg, > 0
  Vec3 velocity;    ///< m/s
};

/// Velocities after contact of a and b with normal n from a to b. They may approach each other at `closing`
/// m/s (>= 0) at most. Impulses are equal and opposite. Returns whether they touch.
inline bool meet(FieldNode& a, FieldNode& b, const Vec3& n, double closing, double friction) {
  const Vec3 w = b.velocity - a.velocity;
  const double apart = dot(w, n);
  if (!(apart < -closing)) return false;
  const double mass = a.mass * b.mass / (a.mass + b.mass), push = mass * (-closing - apart);
  const Vec3 along = w - n * apart;
  const double slides = mass * norm(along), most = friction * push;
  const Vec3 impulse = n * push - along * (slides > most ? mass * most / slides : mass);
  a.velocity -= impulse / a.mass, b.velocity += impulse / b.mass;
  return true;
}

}  // namespace truestep::mpm
