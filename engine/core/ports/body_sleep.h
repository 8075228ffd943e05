// Bodies that fall asleep, as couplings see them: what the owner of a BodyPort may name (BodyOwner::sleep).
// Impulses wake a body (BodyOwner::wake resets its timer); a coupling that merely rests on it restores the
// timer. A coupling that leads a body through a step says so, until it wakes the body again.
#pragma once
#include "engine/core/state/state.h"
#include "engine/math/vec3.h"

namespace truestep {

class BodySleep {
 public:
  virtual ~BodySleep() = default;
  /// s, a timer below 0: the body neither rests nor gives way, it is led.
  static constexpr double kLed = -1;
  /// m/s, speed below which a body may rest.
  virtual double sleep_speed() const = 0;
  virtual bool asleep(const State& state, size_t row) const = 0;
  /// s for which the body in that row has been at rest, or kLed.
  virtual double sleep_timer(const State& state, size_t row) const = 0;
  virtual void set_sleep_timer(State& state, size_t row, double seconds) const = 0;
  /// Leads the body through the next step by its velocities, which are the means of that step, whatever it
  /// meets. They change in it at these rates (m/s^2, rad/s^2): as what lies on the body feels them.
  virtual void lead(State& state, size_t row, const Vec3& rate, const Vec3& spin_rate) const = 0;
};

}  // namespace truestep
