// All the surfaces near a point, for matter that several of them hold at once: in a corner of colliders each
// counts, and what one of them hides does not.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "engine/collision/points/collider_set.h"
#include "engine/collision/points/point_contact.h"

namespace truestep {

/// m, largest n . (p - pose.position) over the points p of a collider, for a unit vector n; infinity where it
/// has no end.
inline double farthest_along(const Collider& c, const Pose& pose, const Vec3& n) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  if (c.shape.side == PointSide::inside) return kEndless;
  const Vec3 local = rotation(pose.orientation).apply_inverse(n), size = c.shape.size;
  switch (c.shape.kind) {
    case ShapeKind::plane:
      return dot(size, local) < 1 - 1e-12 ? kEndless : 0;
    case ShapeKind::box:
      return size.x * std::abs(local.x) + size.y * std::abs(local.y) + size.z * std::abs(local.z);
    case ShapeKind::sphere:
      return size.x;
    case ShapeKind::capsule:
      break;
  }
  return size.x + size.y * std::abs(local.y);
}

/// The surface of collider k that is nearest to x at time t.
inline NearSurface surface_of(const ColliderSet& set, size_t k, const Vec3& x, double t) {
  const Collider& c = set.colliders()[k];
  const Pose pose = moved(c.start, c.motion, t);
  const Rotation r = rotation(pose.orientation);
  const SurfaceDistance<double> local = solid_distance(c.shape, r.apply_inverse(x - pose.position));
  const double side = c.shape.side == PointSide::outside ? 1 : -1;
  NearSurface out{
      .collider = k, .distance = side * local.d, .normal = r.apply(local.n) * side, .velocity = {}};
  if (c.motion.at_rest()) return out;
  const SweptCollider swept = sweep_collider(c, c.surface, t, 1e-4, 0);
  out.velocity = swept.velocity + cross(swept.spin, x - pose.position);
  return out;
}

/// The surfaces nearer to x than `reach` (m) at time t, nearest first, into `out`, as many as fit; returns
/// their number. A solid that lies wholly behind the tangent plane of a nearer one, as the next of a row of
/// boxes, is left out: it adds nothing there.
inline size_t surfaces_within(const ColliderSet& set, const Vec3& x, double t, double reach,
                              std::span<NearSurface> out) {
  size_t count = 0;
  for (size_t k = 0; k < set.colliders().size(); ++k) {
    const NearSurface s = surface_of(set, k, x, t);
    if (!(s.distance < reach)) continue;
    if (count == out.size()) {
      if (count == 0 || s.distance >= out[count - 1].distance) continue;
      --count;
    }
    size_t place = count++;
    for (; place > 0 && out[place - 1].distance > s.distance; --place) out[place] = out[place - 1];
    out[place] = s;
  }
  size_t kept = std::min<size_t>(count, 1);
  for (size_t j = 1; j < count; ++j) {
    const Collider& c = set.colliders()[out[j].collider];
    const Pose pose = moved(c.start, c.motion, t);
    const auto hides = [&](const NearSurface& front) {
      const double level = dot(front.normal, x) - front.distance;
      return dot(front.normal, pose.position) + farthest_along(c, pose, front.normal) <= level + 1e-6 * reach;
    };
    if (std::any_of(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(kept), hides)) continue;
    out[kept++] = out[j];
  }
  return kept;
}

}  // namespace truestep
