// Motion of a body during a step: a straight path, and a rotation at a constant rate the shorter way. x(t) =
// x0 + t (x1 - x0), R(t) = exp(t turn) R0, 0 <= t <= 1
#pragma once
#include "engine/geometry/transform.h"

namespace truestep {

struct Sweep {
  Pose from;
  Vec3 move;  ///< m
  Vec3 turn;  ///< rad, axis times angle, at most pi

  Transform at(double t) const;
};

/// Both orientations must be unit.
Sweep sweep_between(const Pose& from, const Pose& to);
/// A body at rest.
inline Sweep resting(const Pose& pose) {
  return {pose, {}, {}};
}

}  // namespace truestep
