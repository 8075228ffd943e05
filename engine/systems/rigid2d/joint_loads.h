// What the joints of a rigid2d state do: their coordinates, and the loads that they pass on, from the
// impulses of the last substep.
#pragma once
#include <span>

#include "engine/systems/rigid2d/columns.h"

namespace truestep::rigid2d {

/// Pose of a body of a joint, which may be the world.
Pose pose_or_world(const Model& model, const State& state, uint32_t body);

/// Its free coordinate: angle of b relative to a (rad), position along the axis (m), or distance (m); those
/// of angles and positions are 0 in the scene's pose. For joints of other kinds the angle.
double joint_coordinate(const Joint& joint, const Model& model, const State& state);

/// Angle of b relative to a (rad), 0 for joints whose bodies do not rotate relative to one another.
double joint_angle(const Joint& joint, const State& state);

/// Force (N) and torque (N m, counter-clockwise) on its second body, at that body's anchor.
struct JointLoad {
  Vec2 force;
  double torque = 0;
};
/// h: s, the substep that the impulses belong to. A broken joint has none.
JointLoad joint_load(const Model& model, const State& state, size_t joint, double h);
/// Force (N) on its first body when its second has this load: the opposite, but for a pulley.
Vec2 force_on_first(const Model& model, const Joint& joint, const State& state, const JointLoad& load);

/// Sizes of the force and torque times the substep (N s, N m s) for the impulses of a joint
/// (columns::joint_impulse).
struct JointImpulse {
  double force = 0, torque = 0;
};
JointImpulse joint_impulse(const Joint& joint, std::span<const double, 6> impulses);

}  // namespace truestep::rigid2d
