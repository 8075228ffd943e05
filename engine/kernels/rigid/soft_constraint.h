// A velocity constraint  J v = 0  with the position error C as a damped spring that is stable for any step h:
//   impulse = -m_eff mass_scale (J v + bias_rate C) - impulse_scale accumulated
// With w = 2 pi f and a = h w (2 z + h w):  bias_rate = w / (2 z + h w),  mass_scale = a / (1 + a),
// impulse_scale = 1 / (1 + a). Catto, "Soft constraints" (GDC 2011) and "Solver2D" (2024). Its equilibrium is
// C = -load / (m_eff w^2); `rigid` recovers the same fraction of C per step without that sag.
#pragma once
#include "engine/math/trig.h"

namespace truestep {

template <class T>
struct SoftConstraint {
  T bias_rate = 0;      ///< 1/s
  T mass_scale = 1;     ///< 1
  T impulse_scale = 0;  ///< 1
};

/// Coefficients of a spring of `hertz` (Hz, 0: velocity only) with damping ratio `ratio`, for steps of h (s).
template <class T>
constexpr SoftConstraint<T> soft_constraint(T hertz, T ratio, T h) {
  if (!(hertz > 0)) return {};
  const T w = T(6.283185307179586476925) * hertz, b = 2 * ratio + h * w, a = h * w * b;
  return {w / b, a / (1 + a), 1 / (1 + a)};
}

/// Recovers the fraction `share` (0 to 1) of the error every h (s), without compliance.
template <class T>
constexpr SoftConstraint<T> rigid_constraint(T share, T h) {
  return {share / h, 1, 0};
}

/// One step of x'' = -w2 x - rate x':  v+ = (1 - scale) v - push x,  x+ = x + h v+.
struct OscillatorStep {
  double push = 0;   ///< 1/s
  double scale = 0;  ///< 1
  /// 1/s: half of an undamped kick. A run of steps that begins with v += half x and ends with v -= half x is
  /// of second order (the Stoermer-Verlet method); 0 for an implicit step.
  double half = 0;
};

/// Square of the angle (rad) by which an oscillator may turn in a step to be resolved: beside others that
/// share its bodies, and where all of them are known.
inline constexpr double kResolved2 = 0.25, kResolvedAlone2 = 1;

/// Coefficients for steps in which the oscillator turns by less than half a radian (`most2`): exact damping,
/// B = exp(-rate h), and the spring force at the start of the step, which is damped too. The equilibrium
/// under a load is exact, the frequency is within w2 h^2 / 24 + rate h / 4, and without damping the energy is
/// conserved. (Matching the frequency instead would shift the equilibrium by rate h / 2.) Stiffer springs
/// take implicit Euler, which they need when coupled to others, and beyond a radian are damped so that they
/// recover half of their error in a step: with full recovery, oscillations build up beside locked rows that
/// respond a pass late. w2 in 1/s^2, rate in 1/s, h in s.
inline OscillatorStep oscillator_step(double w2, double rate, double h, double most2 = kResolved2) {
  const double turned2 = w2 * h * h;
  if (turned2 > most2) {
    if (turned2 > 1) rate += (turned2 - 1) / h;
    const double keep = 1 / (1 + h * rate + turned2);
    return {h * w2 * keep, 1 - keep, 0};
  }
  const double keep = trig::exp(-rate * h);
  return {h * w2 * keep, 1 - keep, 0.5 * h * w2};
}

}  // namespace truestep
