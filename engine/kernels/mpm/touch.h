// Contact of nodes with a rigid body that contains them: impulses j on the nodes, -j on the body,
//   j = A (u + du_v + du_w x r - v),   M du = -sum (j, r x j),
// with u the body's velocity at a node's arm r, v the node's and A the node's mass along the constrained
// directions: the normal if they approach, then along the surface up to Coulomb's bound, or all directions if
// the body is sticky. The body's response is solved together with the nodes' (six unknowns), so a body much
// lighter than the surrounding material does not overshoot. The frictionless contacts are an active set:
// nodes under tension are released, nodes that the body would pass through are added. After the idea of Hu et
// al. 2018 (MLS-MPM, section 5, coupling by penalties), without penalties.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "engine/math/vec3.h"

namespace truestep::mpm {

/// A node inside a body.
struct TouchedNode {
  double mass = 0;   ///< kg
  Vec3 arm, normal;  ///< m, from the body's centre; unit, out of the body
  Vec3 velocity;     ///< m/s, before; the impulse over the mass is added
  Vec3 impulse;      ///< N s, on the node
  bool held = false;
};

enum class Hold : unsigned char { sticky, slip, separate };

/// A touched body: its mass and inertia, and its motion.
struct TouchedBody {
  double mass = 0;              ///< kg; 0: nothing moves it
  std::array<Vec3, 3> inertia;  ///< kg m^2, columns, in the world
  Vec3 velocity, spin;
};

namespace touch_detail {

using Six = std::array<double, 6>;

inline Vec3 at(const Six& u, const Vec3& r) {
  return Vec3{u[0], u[1], u[2]} + cross({u[3], u[4], u[5]}, r);
}
inline void add(Six& to, const Vec3& j, const Vec3& r) {
  const Vec3 l = cross(r, j);
  to[0] += j.x, to[1] += j.y, to[2] += j.z, to[3] += l.x, to[4] += l.y, to[5] += l.z;
}

/// Solves K x = b with K symmetric and positive definite; a direction without stiffness gets 0.
inline Six solve(std::array<Six, 6> k, Six b) {
  std::array<double, 6> d{};
  for (size_t c = 0; c < 6; ++c) {
    d[c] = k[c][c];
    if (!(d[c] > 0)) continue;
    for (size_t r = c + 1; r < 6; ++r) {
      const double f = k[r][c] / d[c];
      for (size_t q = c; q < 6; ++q) k[r][q] -= f * k[c][q];
      b[r] -= f * b[c];
    }
  }
  for (size_t r = 6; r-- > 0;) {
    for (size_t c = r + 1; c < 6; ++c) b[r] -= k[r][c] * b[c];
    b[r] = d[r] > 0 ? b[r] / d[r] : 0;
  }
  return b;
}

/// The body's change of motion if node n responds to velocity w with the impulse `hold(n, w)` (N s).
template <class HoldOf>
Six answer(std::span<const TouchedNode> nodes, const TouchedBody& body, const HoldOf& hold) {
  if (!(body.mass > 0)) return {};
  std::array<Six, 6> k{};
  Six b{};
  for (size_t c = 0; c < 3; ++c) {
    k[c][c] = body.mass;
    k[3][3 + c] = body.inertia[c].x, k[4][3 + c] = body.inertia[c].y, k[5][3 + c] = body.inertia[c].z;
  }
  for (const TouchedNode& n : nodes) {
    if (!n.held) continue;
    for (size_t c = 0; c < 6; ++c) {
      Six unit{};
      unit[c] = 1;
      const Vec3 j = hold(n, at(unit, n.arm)), l = cross(n.arm, j);
      k[0][c] += j.x, k[1][c] += j.y, k[2][c] += j.z, k[3][c] += l.x, k[4][c] += l.y, k[5][c] += l.z;
    }
    add(b, -hold(n, body.velocity + cross(body.spin, n.arm) - n.velocity), n.arm);
  }
  return solve(k, b);
}

}  // namespace touch_detail

/// Finds the impulses between the nodes and the body and applies them to both. The total impulse on nodes and
/// body is zero to rounding, about every point.
inline void touch(std::span<TouchedNode> nodes, TouchedBody& body, Hold kind, double friction) {
  using namespace touch_detail;
  constexpr int kRounds = 8;
  const auto move = [&](const Six& du) {
    body.velocity += Vec3{du[0], du[1], du[2]}, body.spin += Vec3{du[3], du[4], du[5]};
  };
  const auto pushes = [&](const auto& hold, const Six& du) {
    const TouchedBody moved{body.mass, body.inertia, body.velocity + Vec3{du[0], du[1], du[2]},
                            body.spin + Vec3{du[3], du[4], du[5]}};
    for (TouchedNode& n : nodes) {
      if (!n.held) continue;
      const Vec3 j = hold(n, moved.velocity + cross(moved.spin, n.arm) - n.velocity);
      n.impulse += j, n.velocity += j / n.mass;
    }
    move(du);
  };
  for (TouchedNode& n : nodes) n.impulse = {}, n.held = true;
  if (kind == Hold::sticky) {
    const auto all = [](const TouchedNode& n, const Vec3& w) { return w * n.mass; };
    return pushes(all, answer(nodes, body, all));
  }
  const auto along = [](const TouchedNode& n, const Vec3& w) {
    return n.normal * (n.mass * dot(w, n.normal));
  };
  const auto approach = [&](const TouchedNode& n, const Six& du) {
    return dot(body.velocity + cross(body.spin, n.arm) + at(du, n.arm) - n.velocity, n.normal);
  };
  Six du{};
  if (kind == Hold::separate) {
    for (TouchedNode& n : nodes) n.held = approach(n, {}) > 0;
    for (int round = 0; round < kRounds; ++round) {
      du = answer(nodes, body, along);
      bool same = true;
      for (TouchedNode& n : nodes) {
        const bool held = approach(n, du) > 0;
        same = same && held == n.held;
        n.held = held;
      }
      if (same) break;
    }
  }
  du = answer(nodes, body, along);
  pushes(along, du);
  if (kind != Hold::separate || !(friction > 0)) return;
  const auto beside = [](const TouchedNode& n, const Vec3& w) { return w - n.normal * dot(w, n.normal); };
  // The share of the sliding velocity that the bound allows to stop.
  const auto held = [&](const TouchedNode& n, const Vec3& w) {
    const double slides = norm(beside(n, body.velocity + cross(body.spin, n.arm) - n.velocity)) * n.mass;
    const double most = friction * std::max(0.0, dot(n.impulse, n.normal));
    return beside(n, w) * (n.mass * (slides > most ? most / slides : 1));
  };
  pushes(held, answer(nodes, body, held));
}

}  // namespace truestep::mpm
