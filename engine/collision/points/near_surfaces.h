// All the surfaces near a point, for matter that several of them hold at once: in a corner of colliders each
// counts, and what one of them hides does not.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "engine/collision/points/collider_set.h"
#include "engine/collision/points/images.h"
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

/// The surfaces nearer to x than `reach` (m) at time t, of colliders and their images, nearest first, into
/// `out`, as many as fit; returns their number. `images`: by collider. A solid that lies wholly behind the
/// tangent plane of a nearer one, as the next of a row of boxes, is left out: it adds nothing there.
inline size_t surfaces_within(const ColliderSet& set, std::span<const Images> images, const Vec3& x, double t,
                              double reach, std::span<NearSurface> out) {
  size_t count = 0;
  const auto insert = [&](size_t k, const Vec3& shift) {
    auto s = set.surface_of(k, x - shift, t, reach);
    if (!s || !(s->distance < reach)) return;
    if (count == out.size()) {
      if (count == 0 || s->distance >= out[count - 1].distance) return;
      --count;
    }
    s->shift = shift;
    size_t place = count++;
    for (; place > 0 && out[place - 1].distance > s->distance; --place) out[place] = out[place - 1];
    out[place] = *s;
  };
  for (size_t k = 0; k < set.colliders().size(); ++k) {
    if (!images[k].any()) {
      insert(k, {});
      continue;
    }
    const Collider& c = set.colliders()[k];
    const double near = bounding_radius(c.shape) + reach;
    images[k].each(x - moved(c.start, c.motion, t).position, {near, near, near},
                   [&](const Vec3& shift) { insert(k, shift); });
  }
  size_t kept = std::min<size_t>(count, 1);
  for (size_t j = 1; j < count; ++j) {
    const Collider& c = set.colliders()[out[j].collider];
    const Pose pose = moved(c.start, c.motion, t);
    const auto hides = [&](const NearSurface& front) {
      const double level = dot(front.normal, x) - front.distance;
      const double origin = dot(front.normal, pose.position + out[j].shift);
      return origin + farthest_along(c, pose, front.normal) <= level + 1e-6 * reach;
    };
    if (std::any_of(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(kept), hides)) continue;
    out[kept++] = out[j];
  }
  return kept;
}

}  // namespace truestep
