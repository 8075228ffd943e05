// Boundary conditions at nodes: the sides of the box, colliders, nozzles; each sticky, slipping, or
// separating with Coulomb friction.
#pragma once
#include <cmath>

#include "engine/systems/mpm/blocks.h"
#include "engine/systems/mpm/solver.h"

namespace truestep::mpm {

/// Velocity of a node at a boundary that moves with `of`, with unit normal n into the free side.
template <class T>
Vec3T<T> bounded(const Vec3T<T>& v, const Vec3T<T>& n, const Vec3T<T>& of, Contact kind, T friction) {
  if (kind == Contact::sticky) return of;
  const Vec3T<T> relative = v - of;
  const T into = dot(relative, n);
  if (kind == Contact::separate && into >= 0) return v;
  const Vec3T<T> along = relative - n * into;
  if (kind == Contact::slip) return of + along;
  // Coulomb's bound on the impulse along the boundary.
  const T speed = norm(along);
  return speed > -friction * into ? of + along * (1 + friction * into / speed) : of;
}

template <int D, int Nodes, class T>
struct Boundaries {
  using Size = Tiling<D, Nodes>;
  Blocks<D, Nodes, T> blocks;

  /// Whether no node of the block is at a wall.
  bool is_inside(const MpmDef& def, const Block& b) const {
    const double far[3] = {def.high.x, def.high.y, def.high.z};
    for (int a = 0; a < D; ++a) {
      const int first = b.at[a] * Size::kBlock - Size::kPad;
      if (first <= 0 || blocks.low[a] + (first + Size::kBlock) * def.cell >= far[a]) return false;
    }
    return true;
  }
  /// m, position of a node of a block.
  Vec3 place_of(const MpmDef& def, const Block& b, size_t n) const {
    double x[3] = {};
    for (int a = D - 1; a >= 0; --a, n /= Size::kBlock) {
      const int at = b.at[a] * Size::kBlock + static_cast<int>(n % Size::kBlock) - Size::kPad;
      x[a] = blocks.low[a] + at * def.cell;
    }
    return {x[0], x[1], x[2]};
  }
  /// Visits the boundaries that act on a node at x, in order: visit(normal into the free side, velocity,
  /// kind, friction).
  template <class Visit>
  void for_boundaries(const Setting& set, const Vec3& place, double t, const Visit& visit) const {
    const MpmDef& def = set.def;
    const double x[3] = {place.x, place.y, place.z}, far[3] = {def.high.x, def.high.y, def.high.z};
    const Contact floor = def.floor == MpmDef::Floor::as_walls ? def.walls : static_cast<Contact>(def.floor);
    const auto single = [](const Vec3& a) {
      return Vec3T<T>{static_cast<T>(a.x), static_cast<T>(a.y), D == 3 ? static_cast<T>(a.z) : T{0}};
    };
    if (!set.colliders.empty()) {
      const NearSurface near = set.colliders.nearest(place, t);
      if (near.collider != NearSurface::kNone && near.distance < 0) {
        const double mu = set.colliders.colliders()[near.collider].surface.friction;
        visit(single(near.normal), single(near.velocity), def.contact, static_cast<T>(mu));
      }
    }
    for (const Inlet& inlet : set.inlets) {
      if (inlet.holds(place, t, 0.5 * def.cell))
        visit(single(inlet.along), single(inlet.velocity()), Contact::sticky, T{0});
    }
    const T slack = static_cast<T>(1e-6 * def.cell), mu = static_cast<T>(def.wall_friction);
    for (int a = 0; a < D; ++a) {
      const bool below = x[a] <= blocks.low[a] + slack, above = x[a] >= far[a] - slack;
      if (!below && !above) continue;
      const T side = below ? T{1} : T{-1};
      const Vec3T<T> n_wall{a == 0 ? side : 0, a == 1 ? side : 0, a == 2 ? side : 0};
      visit(n_wall, Vec3T<T>{}, below && a == 1 ? floor : def.walls, mu);
    }
  }
  /// Velocity of a node at x after colliders, nozzles and walls.
  Vec3T<T> held(const Setting& set, const Vec3& place, double t, Vec3T<T> v) const {
    for_boundaries(set, place, t, [&](const Vec3T<T>& n, const Vec3T<T>& of, Contact kind, T friction) {
      v = bounded(v, n, of, kind, friction);
    });
    return v;
  }
  /// Whether no boundary acts on any node of the block at time t: every collider is farther from the block's
  /// middle than its corners are.
  bool is_free(const Setting& set, const Block& b, double t) const {
    if (!set.inlets.empty() || !is_inside(set.def, b)) return false;
    if (set.colliders.empty()) return true;
    const double half = 0.5 * (Size::kBlock - 1) * set.def.cell;
    const Vec3 middle = place_of(set.def, b, 0) + Vec3{half, half, D == 3 ? half : 0};
    return set.colliders.clearance(middle, t) > half * (D == 2 ? 1.42 : 1.74);
  }
};

}  // namespace truestep::mpm
