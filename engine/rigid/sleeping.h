// When a body may sleep. Slow alone is not at rest: a pendulum is slow where it turns, what begins to fall is
// slow at first. A body rests while its points are slow and stay near the place where its rest began: on the
// average over that time it moves by no more than 0.4 of sleep_speed, and no force that contacts and joints
// leave over pushes it (a constant one would bend its way). Balls and capsules roll in heaps at some mm/s for
// ever; at an eighth of sleep_speed, of three heaps one slept within 10 s of rest. (Box2D and Rapier ask for
// speeds alone, 0.05 and 0.4 m/s for 0.5 and 2 s; Jolt for points within 15 mm for 0.5 s.) An island sleeps
// when all its bodies have rested for sleep_time and something that does not move bears it: a contact under
// load or a joint. What floats free never sleeps, unless it does not move at all.
#pragma once

namespace truestep {

struct SleepRule {
  double speed = 0.05, time = 0.5;  ///< m/s, s

  /// m by which a resting body's points may go from where its rest began.
  double drift() const { return 0.4 * speed * time; }
  /// m by which the middle of its way in sleep_time may lie beside the middle between its ends: a force that
  /// is left over, as on a pendulum that turns back, bends the way by a (time / 2)^2 / 2.
  double bend() const { return 0.0125 * speed * time; }
};

/// s that a body has rested after a step of h. `before`: at the step's start (0: its rest begins, at this
/// place); `speed`, `moved`: bounds of its points' speed (m/s) and of their distance (m) from where its rest
/// began.
inline double rest_after(double before, double h, double speed, double moved, const SleepRule& rule) {
  return speed <= rule.speed && (before == 0 || moved <= rule.drift()) ? before + h : 0;
}

}  // namespace truestep
