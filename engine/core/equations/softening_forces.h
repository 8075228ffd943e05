// Interface of fields whose stiffest forces hold points at given distances: they can be made temporarily
// softer, with shifted lengths, so that the full tensions arise at the right lengths. With T = k (l - L)
// wanted and only s k in use, 0 < s < 1, the shifted L' = L - T (1 - s) / (s k) gives T at l = L + T / k.
// Newton's method then meets neither the narrow valley of the full forces nor their rounding (the method of
// multipliers of Hestenes 1969 and Powell 1969, whose multipliers are the tensions).
#pragma once
#include "engine/core/equations/force_field.h"

namespace truestep {

class SofteningForces {
 public:
  virtual ~SofteningForces() = default;
  /// Upper bound of the squared frequencies of these forces, 1/s^2.
  virtual double fastest_squared(const State& state) const = 0;
  /// Until `restore`, all evaluations with this workspace have these forces reduced to `share`.
  virtual void soften(State& state, double share, Evaluation& e) const = 0;
  /// How far lengths are from where the present tensions belong (m, the largest), and the stretch by the
  /// tensions.
  struct Lengths {
    double off = 0, stretched = 0;
  };
  /// Shifts lengths by the tensions at `at` for forces reduced to `share` from now on; returns the state
  /// before.
  virtual Lengths shift(const Phase& at, State& state, double share, Evaluation& e) const = 0;
  /// Restores everything as it was before `soften`, to the bit.
  virtual void restore(State& state, Evaluation& e) const = 0;

  /// Until `release_tensions`, derivatives of forces (not the forces) are those under tensions of their own:
  /// at first those at `at`, with the present stiffness and lengths.
  virtual void hold_tensions(const Phase& at, Evaluation& e) const = 0;
  /// They become what a motion of the points by `s` times `u` (m) from `at` makes of the forces there, to the
  /// first order of lengths. Returns the part of the motion, and of the change, that turns no force by more
  /// than `most_turn` (rad).
  virtual double predict_tensions(const Phase& at, std::span<const double> u, double s, double most_turn,
                                  Evaluation& e) const = 0;
  virtual void release_tensions(Evaluation& e) const = 0;
};

}  // namespace truestep
