// What a field can do whose stiffest forces pull points to lengths: be softer for a while, with lengths
// shifted so that the tensions of the whole forces come about at the lengths that they belong to. With T = k
// (l - L) wanted and only s k in use, 0 < s < 1, the shifted L' = L - T (1 - s) / (s k) gives T at l = L + T
// / k. Newton's method then meets neither the narrow valley of the whole forces nor their rounding (the
// method of multipliers of Hestenes 1969 and Powell 1969, whose multipliers are the tensions).
#pragma once
#include "engine/core/force_field.h"

namespace truestep {

class SofteningForces {
 public:
  virtual ~SofteningForces() = default;
  /// Bound of the squared frequencies of these forces, 1/s^2.
  virtual double fastest_squared(const State& state) const = 0;
  /// All evaluations with this workspace have forces that are smaller by `share`, until `restore`.
  virtual void soften(State& state, double share, Evaluation& e) const = 0;
  /// How far lengths are from where the present tensions belong (m, the largest), and what tensions stretch.
  struct Lengths {
    double off = 0, stretched = 0;
  };
  /// Shifts lengths by the tensions at `at` for forces that are smaller by `share` from now on; what was
  /// before.
  virtual Lengths shift(const Phase& at, State& state, double share, Evaluation& e) const = 0;
  /// Everything is as before `soften`, to the bit.
  virtual void restore(State& state, Evaluation& e) const = 0;
};

}  // namespace truestep
