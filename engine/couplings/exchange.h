// What a coupling has exchanged since t = 0: columns of its own state, and how they are observed.
#pragma once
#include <cmath>

#include "engine/core/coupling.h"

namespace truestep {

/// Sums over one substep, added to the state at its end.
struct Exchange {
  Vec3 impulse;            ///< N s, given by a to b
  double magnitudes = 0;   ///< N s, sum of the impulses' magnitudes
  double energy_lost = 0;  ///< J

  /// Adds an impulse on b (the opposite on a), and the kinetic energy that it removed.
  void add(const Vec3& on_b, double lost) {
    impulse += on_b;
    magnitudes += norm(on_b);
    energy_lost += lost;
  }
};

namespace exchange_columns {
enum : State::Column { impulse, magnitudes, energy_lost, end };
}

/// The columns, filled with zero.
inline State exchange_state() {
  State s;
  s.add({"impulse", "N s", Scalar::f64, 3}, 1);
  s.add({"impulse_sum", "N s"}, 1);
  s.add({"energy_lost", "J"}, 1);
  return s;
}

inline void book(State& own, const Exchange& e) {
  double* impulse = own.f64(exchange_columns::impulse).data();
  store3(impulse, 0, load3(impulse, 0) + e.impulse);
  own.f64(exchange_columns::magnitudes)[0] += e.magnitudes;
  own.f64(exchange_columns::energy_lost)[0] += e.energy_lost;
}

/// impulse.x/y/z and impulse.sum (N s) since t = 0.
inline void observe_impulses(const State& own, Observables& out) {
  const auto p = own.f64(exchange_columns::impulse);
  out.add("impulse.x", p[0], "N s");
  out.add("impulse.y", p[1], "N s");
  out.add("impulse.z", p[2], "N s");
  out.add("impulse.sum", own.f64(exchange_columns::magnitudes)[0], "N s");
}

/// Those and energy.lost (J) since t = 0.
inline void observe_exchange(const State& own, Observables& out) {
  observe_impulses(own, out);
  out.add("energy.lost", own.f64(exchange_columns::energy_lost)[0], "J");
}

}  // namespace truestep
