// One point against the solids of one step: internals of ColliderSet::resolve.
#pragma once
#include <optional>
#include <span>

#include "engine/collision/collider.h"
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
  double gap = 0;            ///< m, distance kept: point radius + slop
  Vec3 low, high;            ///< box that holds every place where a point could touch from outside
  Vec3 safe_low, safe_high;  ///< box inside which a container holds points anyway (empty when it moves)
  enum class Motion : uint8_t { fixed, moving } motion = Motion::fixed;
};

SweptCollider sweep_collider(const Collider& c, const Surface& surface, double t, double h, double radius);

/// True when a point that moves straight from a to b during the whole step cannot touch.
bool clear_of(const SweptCollider& c, const Vec3& a, const Vec3& b);

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
