// One point against the solids of one step: internals of ColliderSet::resolve.
#pragma once
#include <optional>
#include <span>

#include "engine/collision/points/collider.h"
#include "engine/math/quaternion.h"

namespace truestep {

/// A collider during one step: poses at both ends and what the tests of many points share.
struct SweptCollider {
  Shape shape;
  Surface surface;
  Pose begin, end;
  Rotation begin_rotation, end_rotation;
  Vec3 velocity;             ///< mean over the step, m/s
  Vec3 spin;                 ///< rad/s
  Vec3 end_normal;           ///< plane: unit normal at the step's end
  double end_level = 0;      ///< plane: end_normal . x beyond which nothing touches, m
  double gap = 0;            ///< m, distance kept: point radius + slop
  Vec3 low, high;            ///< box of all positions where a point could touch from outside
  Vec3 safe_low, safe_high;  ///< box inside which a container holds points in any case (empty when it moves)
  enum class Motion : uint8_t { fixed, moving } motion = Motion::fixed;
};

SweptCollider sweep_collider(const Collider& c, const Surface& surface, double t, double h, double radius);

/// True when a point that ends at b cannot have left the container.
bool held_by(const SweptCollider& c, const Vec3& b);

/// True when a point that moves straight from a to b during the whole step cannot touch. Branch-free: most
/// points are far from most solids, but which ones is unpredictable.
inline bool clear_of(const SweptCollider& c, const Vec3& a, const Vec3& b) {
  if (c.shape.kind == ShapeKind::plane) return dot(c.end_normal, b) > c.end_level;
  if (c.shape.side == PointSide::inside) return held_by(c, b);
  const auto apart = [](double p, double q, double low, double high) {
    const double small = p < q ? p : q, large = p < q ? q : p;
    return static_cast<int>(large < low) | static_cast<int>(small > high);
  };
  return (apart(a.x, b.x, c.low.x, c.high.x) | apart(a.y, b.y, c.low.y, c.high.y) |
          apart(a.z, b.z, c.low.z, c.high.z)) != 0;
}

/// A point in the step of length h: position and velocity at fraction `from` of it.
struct PointFlight {
  Vec3 x, v, a;
  double from = 0;
};

/// Advances a point to the step's end with all its contacts; `v_old`: its velocity when the step began,
/// `offset`: v_new minus the path's final velocity. Returns position and velocity.
struct PointEnd {
  Vec3 x, v;
};
PointEnd advance_point(std::span<const SweptCollider> colliders, PointFlight flight, const Vec3& v_old,
                       Vec3 offset, double h);

}  // namespace truestep
