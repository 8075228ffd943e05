// A velocity constraint  J v = 0  over the position error C as a damped spring that is stable at any step h:
//   impulse = -m_eff mass_scale (J v + bias_rate C) - impulse_scale accumulated
// With w = 2 pi f and a = h w (2 z + h w):  bias_rate = w / (2 z + h w),  mass_scale = a / (1 + a),
// impulse_scale = 1 / (1 + a). Catto, "Soft constraints" (GDC 2011) and "Solver2D" (2024). It rests at
// C = -load / (m_eff w^2); `rigid` takes back the same share of C a step without that sag.
#pragma once

namespace truestep {

template <class T>
struct SoftConstraint {
  T bias_rate = 0;      ///< 1/s
  T mass_scale = 1;     ///< 1
  T impulse_scale = 0;  ///< 1
};

/// Of a spring of `hertz` (Hz, 0: velocity only) with damping ratio `ratio`, for steps of h (s).
template <class T>
constexpr SoftConstraint<T> soft_constraint(T hertz, T ratio, T h) {
  if (!(hertz > 0)) return {};
  const T w = T(6.283185307179586476925) * hertz, b = 2 * ratio + h * w, a = h * w * b;
  return {w / b, a / (1 + a), 1 / (1 + a)};
}

/// Takes `share` (0 to 1) of the error back every h (s), without compliance.
template <class T>
constexpr SoftConstraint<T> rigid_constraint(T share, T h) {
  return {share / h, 1, 0};
}

}  // namespace truestep
