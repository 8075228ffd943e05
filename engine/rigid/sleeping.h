// When a body may sleep. A low speed alone is not rest: a pendulum is slow at its turning points, a falling
// body at the start. A body rests while its points are slow and stay near where its rest began: over that
// time it moves at no more than an eighth of sleep_speed on average, and no residual force of contacts and
// joints pushes it (a constant one would carry it farther). An island sleeps when all its bodies have rested
// for sleep_time and something static supports it: a contact under load or a joint. Freely floating bodies
// never sleep unless they do not move at all. Bodies held by friction alone may move at 0.4 of sleep_speed:
// balls and capsules keep rolling in heaps at some mm/s, and with an eighth two of three heaps stayed awake
// for 20 s and more. Bodies that touch nothing and hang on joints or springs swing without loss, slowly at
// their turning points: they rest only in balance, at a tenth of the mean speed and a hundredth of the
// acceleration that others may have. (Box2D and Rapier test speeds alone, 0.05 and 0.4 m/s for 0.5 and 2 s;
// Jolt tests for points within 15 mm for 0.5 s.)
#pragma once
#include <cmath>

namespace truestep {

struct SleepRule {
  double speed = 0.05, time = 0.5;  ///< m/s, s
  double share = 0.125;             ///< of `speed`, the largest average speed of a resting body
  double curve = 0.0125;            ///< of `speed` times `time`, the largest bend of its path

  /// The rule for bodies held by nothing but friction with others.
  SleepRule of_rolling() const { return {speed, time, 0.4, curve}; }
  /// The rule for bodies that touch nothing: at the defaults at most 0.6 mm/s and 1e-4 m/s^2, so that no
  /// oscillation of 0.025 Hz or more and above 1 mm/s falls asleep.
  SleepRule of_hanging() const { return {speed, time, 0.1 * share, 0.01 * curve}; }

  /// m, largest distance of a resting body's points from where its rest began.
  double drift() const { return share * speed * time; }
  /// m, largest distance between the midpoint of the path in sleep_time and the midpoint of its ends: a
  /// residual acceleration a, as at a pendulum's turning point, bends the path by a (time / 2)^2 / 2: a body
  /// that sleeps has had at most 8 curve speed / time.
  double bend() const { return curve * speed * time; }
};

/// s for which a body has rested after a step of h. `before`: value at the start of the step (0: its rest
/// begins at this position); `speed`, `moved`: bounds on the speed of its points (m/s) and on their distance
/// (m) from where its rest began.
inline double rest_after(double before, double h, double speed, double moved, const SleepRule& rule) {
  return speed <= rule.speed && (before == 0 || moved <= rule.drift()) ? before + h : 0;
}

/// Speed of a body that must not rest.
inline constexpr double kNoRest = HUGE_VAL;

/// Counts a step of h into `timer`, the s for which the body has rested. `way` tracks its path: begin()
/// stores the position where its rest begins, moved() is the distance from there (m), pass() stores the
/// position halfway through sleep_time, bend() is its distance from the midpoint of both ends (m).
template <class Way>
void count_rest(double& timer, double h, double speed, const SleepRule& rule, Way&& way) {
  const double before = timer;
  if (before == 0) way.begin();
  timer = rest_after(before, h, speed, way.moved(), rule);
  if (before <= 0.5 * rule.time) way.pass();
  if (before < rule.time && timer >= rule.time && way.bend() > rule.bend()) timer = 0;
}

}  // namespace truestep
