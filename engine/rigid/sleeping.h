// When a body may sleep. Slow alone is not at rest: a pendulum is slow where it turns, what begins to fall is
// slow at first. A body rests while its points are slow and stay near the place where its rest began: on the
// average over that time it moves by no more than an eighth of sleep_speed, and no force that contacts and
// joints leave over pushes it (a constant one would carry it further). An island sleeps when all its bodies
// have rested for sleep_time and something that does not move bears it: a contact under load or a joint. What
// floats free never sleeps, unless it does not move at all.
// What only friction holds may go on at 0.4 of sleep_speed: balls and capsules roll in heaps at some mm/s for
// ever, and at an eighth two of three heaps were awake for 20 s and more. (Box2D and Rapier ask for speeds
// alone, 0.05 and 0.4 m/s for 0.5 and 2 s; Jolt for points within 15 mm for 0.5 s.)
#pragma once
#include <cmath>

namespace truestep {

struct SleepRule {
  double speed = 0.05, time = 0.5;  ///< m/s, s
  double share = 0.125;             ///< of `speed`, that a body may have on the average

  /// The rule for what touches others with friction and is held by nothing else.
  SleepRule of_rolling() const { return {speed, time, 0.4}; }

  /// m by which a resting body's points may go from where its rest began.
  double drift() const { return share * speed * time; }
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

/// Speed of a body that must not rest.
inline constexpr double kNoRest = HUGE_VAL;

/// Counts a step of h into `timer`, s that a body has rested. `way` knows how it went: begin() notes the
/// place where its rest begins, moved() is the distance from there (m), pass() notes the place halfway
/// through sleep_time, bend() how far that lies beside the middle between both ends (m).
template <class Way>
void count_rest(double& timer, double h, double speed, const SleepRule& rule, Way&& way) {
  const double before = timer;
  if (before == 0) way.begin();
  timer = rest_after(before, h, speed, way.moved(), rule);
  if (before <= 0.5 * rule.time) way.pass();
  if (before < rule.time && timer >= rule.time && way.bend() > rule.bend()) timer = 0;
}

}  // namespace truestep
