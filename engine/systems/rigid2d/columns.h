// Columns of a rigid2d state, and how poses are read from them. The world has no row: it is at the origin.
#pragma once
#include <cmath>

#include "engine/core/commands/user_forces.h"
#include "engine/core/state/state.h"
#include "engine/math/trig.h"
#include "engine/systems/rigid2d/model.h"

namespace truestep::rigid2d {

namespace columns {
enum : State::Column {
  position,          // f64 x 3, m: centres of mass
  velocity,          // f64 x 3, m/s
  angle,             // f64, rad, never wrapped
  angular_velocity,  // f64, rad/s
  sleep_timer,       // f64, s that a body has been slow
  sleep_place,       // f64 x 6, m m rad: pose when that began, and pose after half of sleep_time
  status,            // u32, bits of Status
  contact_key,       // u64, shape a << 32 | shape b, ascending
  contact_id,        // u32 x 2, features; kNoPoint for a missing second point
  contact_impulse,   // f32 x 5, N s: normal and normal, tangential and tangential, rolling (N m s)
  contact_offset,    // f32 x 2, m, yield of each point under its load
  joint_impulse,     // f64 x 6, see solver_joint.h
  joint_broken,      // u32
  substeps,          // u32 x 1, substeps of the last step; 0 before the first
  parameters,        // f64 x 3: gravity
  push_body,         // u32
  push_force,        // f64 x 3, N
  push_local,        // f64 x 2, m, point of action about the centre of mass in the body's frame
  push_remaining,    // f64, s
  drag_body,         // u32
  drag_local,        // f64 x 2, m
  drag_target,       // f64 x 3, m
  drag_stiffness,    // f64, N/m
  drag_impulse,      // f64 x 2, N s
  joint_motor,       // f64 x 3, see Motor; only where a joint has a motor
  joint_turn_motor,  // f64 x 2, of the same rows; only where a joint is of type motor
};
inline constexpr UserForces kHands{{push_body, push_force, push_remaining, push_local},
                                   {drag_body, drag_target, drag_stiffness, drag_local, drag_impulse}};
}  // namespace columns

/// A drag as a spring joint of this step, with damping ratio 0.7: it follows the pointer with little
/// overshoot.
inline Joint drag_joint(const Model& model, const UserForces::Drag& d) {
  Joint j;
  j.kind = JointKind::mouse, j.a = model.world(), j.b = static_cast<uint32_t>(d.who);
  j.local_b = flat::flatten(d.at), j.ground_a = flat::flatten(d.target);
  j.hertz = std::sqrt(d.stiffness / model.bodies[j.b].mass) / 6.283185307179586;
  j.damping_ratio = 0.7, j.max_force = HUGE_VAL;
  return j;
}

/// What the motor of a joint aims at: its speed or position (m/s, m, rad/s or rad; of a motor joint its move
/// or velocity in the frame of a; of a mouse its target in the world), and its maximum force or torque; of a
/// motor joint also its turn or spin (rad or rad/s) and its maximum torque.
struct Motor {
  Vec2 wanted;
  double most = HUGE_VAL;
  double turn = 0, most_turn = 0;
};
inline Motor motor_of(const State& s, const Joint& j) {
  const double* m = s.f64(columns::joint_motor).data() + 3 * static_cast<size_t>(j.motor_row);
  Motor motor{.wanted = {m[0], m[1]}, .most = m[2]};
  if (j.kind == JointKind::motor) {
    const double* t = s.f64(columns::joint_turn_motor).data() + 2 * static_cast<size_t>(j.motor_row);
    motor.turn = t[0], motor.most_turn = t[1];
  }
  return motor;
}

inline constexpr uint32_t kNoPoint = 0xffffffff;

enum Status : uint32_t { kAwake = 1, kPinned = 2, kRemoved = 4 };

State state_at_start(const Model& model, const Vec3& gravity);

/// True where the solver moves the body in this state: dynamic, awake, neither pinned nor removed.
inline bool is_moved(const Light& b, uint32_t status) {
  return b.motion == Motion::dynamic && status == kAwake;
}
inline bool is_asleep(const Light& b, uint32_t status) {
  return b.motion == Motion::dynamic && status == 0;
}

inline Pose pose_of(const State& s, size_t body) {
  const double* x = s.f64(columns::position).data() + 3 * body;
  const trig::SinCos t = trig::sincos(s.f64(columns::angle)[body]);
  return {{x[0], x[1]}, {t.cos, t.sin}};
}

/// Wakes the bodies of `seeds` (flags, one per body; the world's is ignored) and every sleeping body that
/// touches or is joined to one of them, directly or through others. Returns whether any woke.
bool wake_islands(const Model& model, State& s, std::span<const uint8_t> seeds);

}  // namespace truestep::rigid2d
