// Queries of one solid, two solids, or all bodies of a broad phase: rays (ray_cast.h), casts of a moving
// solid, nearest points, overlap. Bodies are passed as a function body(i) -> PlacedSolid.
#pragma once
#include <algorithm>
#include <optional>
#include <vector>

#include "engine/collision/broad/broad_phase.h"
#include "engine/collision/pairs/manifold.h"
#include "engine/collision/queries/ray_cast.h"
#include "engine/collision/queries/time_of_impact.h"

namespace truestep {

/// Signed distance between two solids (negative: depth) and the points that attain it.
struct NearestPoints {
  double distance = 0;    ///< m
  Vec3 point_a, point_b;  ///< on a's and b's surface
  Vec3 normal;            ///< unit, from a to b
};

/// Empty when they are farther apart than `within` (m), or both are surfaces.
std::optional<NearestPoints> nearest_points(const Solid& a, const Transform& at_a, const Solid& b,
                                            const Transform& at_b, double within);
/// Nearest place on a solid to a point, from the point's side of it; empty beyond `within` (m) or behind a
/// mesh or height field.
struct NearestPoint {
  double distance = 0;  ///< m, negative inside
  Vec3 point;           ///< on the surface
  Vec3 normal;          ///< unit, outward
};
std::optional<NearestPoint> nearest_point(const Solid& solid, const Transform& at, const Vec3& point,
                                          double within);
/// True when the two have a point in common.
bool overlap(const Solid& a, const Transform& at_a, const Solid& b, const Transform& at_b);
/// First touch of a solid (convex or compound) that moves without rotating; see time_of_impact.
std::optional<Impact> shape_cast(const Solid& moving, const Pose& from, const Vec3& move, const Solid& target,
                                 const Pose& at, double touch);

/// A body for queries over many.
struct PlacedSolid {
  const Solid* solid = nullptr;
  Pose pose;
};
struct BodyHit {
  uint32_t body = 0;
  RayHit hit;
};

/// True when the ray meets the box no later than `most`.
bool ray_meets(const FloatBox& box, const Ray& ray, double most);

/// First body hit by the ray among those in the broad phase's last update; ties go to the lower number.
template <class Body>
std::optional<BodyHit> ray_cast(const BroadPhase& broad, Body&& body, const Ray& ray, double most) {
  std::optional<BodyHit> best;
  const auto passes = [&](const FloatBox& b) { return ray_meets(b, ray, best ? best->hit.t : most); };
  broad.each(passes, [&](uint32_t i) {
    const PlacedSolid p = body(i);
    const auto hit = ray_cast(*p.solid, transform_of(p.pose), ray, best ? best->hit.t : most);
    if (hit && (!best || hit->t < best->hit.t || (hit->t == best->hit.t && i < best->body))) best = {i, *hit};
  });
  return best;
}
/// All bodies that overlap the solid, ascending.
template <class Body>
void overlapping_bodies(const BroadPhase& broad, Body&& body, const Solid& solid, const Transform& at,
                        std::vector<uint32_t>& out) {
  out.clear();
  broad.overlapping(bounds(solid, at), [&](uint32_t i) {
    const PlacedSolid p = body(i);
    if (overlap(solid, at, *p.solid, transform_of(p.pose))) out.push_back(i);
  });
  std::sort(out.begin(), out.end());
}

/// First body that a convex solid or compound touches along its path (see shape_cast).
struct BodyImpact {
  uint32_t body = 0;
  Impact impact;
};
template <class Body>
std::optional<BodyImpact> shape_cast(const BroadPhase& broad, Body&& body, const Solid& moving,
                                     const Pose& from, const Vec3& move, double touch) {
  Box box = bounds(moving, transform_of(from));
  box.cover(Box{box.low + move, box.high + move});
  std::optional<BodyImpact> best;
  broad.overlapping(box.grown(touch), [&](uint32_t i) {
    const PlacedSolid p = body(i);
    const auto hit = shape_cast(moving, from, move, *p.solid, p.pose, touch);
    if (hit && (!best || hit->t < best->impact.t || (hit->t == best->impact.t && i < best->body)))
      best = {i, *hit};
  });
  return best;
}

}  // namespace truestep
