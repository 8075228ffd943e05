// Columns of a rigid3d state. One row per body, in order of creation; contacts ascend by the rows of their
// bodies and carry the impulses that the next step starts from.
#pragma once
#include <span>

#include "engine/core/commands/user_forces.h"
#include "engine/core/state/state.h"
#include "engine/systems/rigid3d/bodies.h"
#include "engine/systems/rigid3d/joints/joints.h"

namespace truestep::rigid3d {

namespace columns {
enum : State::Column {
  position,           ///< f64 x 3, of the centre of mass
  velocity,           ///< f64 x 3
  orientation,        ///< f64 x 4, of the principal axes
  angular_velocity,   ///< f64 x 3, in the world
  kind,               ///< u32, which BodyKind
  id,                 ///< u64, ascending, never reused
  sleep_timer,        ///< f64, s for which the body has rested; below 0: it is led (BodySleep::kLed)
  sleep_position,     ///< f64 x 3, position when that began
  sleep_orientation,  ///< f64 x 4
  sleep_middle,       ///< f64 x 6, m rad: shift and rotation vector from there after half of sleep_time; of
                      ///< what is led, m/s^2 rad/s^2: rates at which its velocities change
  asleep,             ///< u32
  per_body_end,
  contact_bodies = per_body_end,  ///< u32 x 2
  contact_ids,                    ///< u32 x 5: points, then features of up to four
  contact_normal,                 ///< f64 x 3
  contact_impulse,                ///< f64 x 4, N s of one substep along the normal
  contact_offset,                 ///< f64, m, yield of the contact under its load
  contact_uneven,                 ///< f64 x 4, m, by which a point's offset exceeds the contact's
  contact_friction,               ///< f64 x 4: N s in the world, N m s about the normal
  contact_roll,                   ///< f64 x 3, N m s in the world
  contact_depth,                  ///< f64, m, of the deepest point when it was found; negative: separated
  contacts_end,
  joint_bodies = contacts_end,  ///< u32 x 2, rows, kNoBody: the world
  joint_impulse,                ///< f64 x 6, N s and N m s of one substep along the joint's axes
  joint_load,                   ///< f64 x 6, N and N m on b in the world, of the last substep
  joint_broken,                 ///< u32
  drive_impulse,                ///< f64 x 4: spring, motor, lower, upper; of one substep
  drive_coordinate,             ///< f64, m or rad; full turns are counted
  drive_motor,     ///< f64 x 2: target speed or position of the motor, its maximum force or torque
  counters,        ///< u64: next id
  gravity,         ///< f64 x 3
  substep,         ///< f64, s, length of the last step's substeps; 0 before the first
  push_id,         ///< u64
  push_force,      ///< f64 x 3, N
  push_at,         ///< f64 x 3, m, point on the body, in the frame of its principal axes
  push_remaining,  ///< f64, s
  drag_id,         ///< u64
  drag_target,     ///< f64 x 3, m
  drag_at,         ///< f64 x 3, m, as for pushes
  drag_stiffness,  ///< f64, N/m
};
inline constexpr UserForces kHands{{push_id, push_force, push_remaining, push_at},
                                   {drag_id, drag_target, drag_stiffness, drag_at}};
}  // namespace columns

/// The state at t = 0.
State rigid3d_at_start(const BodyList& bodies, const JointList& joints, const Vec3& gravity);

/// Appends a body.
void append_body(State& s, const BodyStart& b);

/// Row of the body with this id, or nothing.
std::optional<size_t> row_of_body(const State& s, uint64_t id);

/// Removes a body with its contacts, joints, pushes and drags. Bodies that touched it wake up.
void remove_body(State& s, size_t row);

/// Wakes a body and everything that it rests on, carries or is joined to.
void wake_body(State& s, size_t row, std::span<const BodyKind> kinds);

/// Whether what moves the body from outside leads it through this step; `rested`: column sleep_timer.
inline bool is_led(const double* rested, size_t row) {
  return rested[row] < 0;
}

inline Quat load_quat(const double* p, size_t i) {
  return {p[4 * i], p[4 * i + 1], p[4 * i + 2], p[4 * i + 3]};
}
inline void store_quat(double* p, size_t i, const Quat& q) {
  p[4 * i] = q.w, p[4 * i + 1] = q.x, p[4 * i + 2] = q.y, p[4 * i + 3] = q.z;
}

}  // namespace truestep::rigid3d
