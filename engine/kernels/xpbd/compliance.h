// How a constraint C(x) = 0 of finite stiffness enters a position-based step of length h. With energy
// E = 1/2 C^2 / alpha and damping beta along the constraint (Macklin, Mueller, Chentanez 2016, "XPBD",
// eqs. 18 and 26; lambda in units of h^2):
//   (alpha~ + (1 + gamma) grad C M^-1 grad C^T) d_lambda = -C - alpha~ lambda - gamma grad C . (x - x_n),
//   alpha~ = alpha / h^2,   gamma = alpha~ beta~ / h = alpha beta / h,
//   x += M^-1 grad C^T d_lambda.
// alpha is 1 / stiffness: 0 is rigid.
#pragma once

namespace truestep::xpbd {

template <class T>
struct Softness {
  T alpha = 0;  ///< alpha~
  T gamma = 0;
};

/// 1/h and 1/h^2 of a substep, which turn compliances into alpha~ and gamma.
template <class T>
struct PerStep {
  T h = 1, h2 = 1;
};
template <class T>
PerStep<T> per_step(double h) {
  return {static_cast<T>(1 / h), static_cast<T>(1 / (h * h))};
}

/// Compliance of absent constraints, such as padded lanes and links of no stiffness: too soft to change a
/// point by a bit.
inline constexpr double kIdle = 1e18;

/// d_lambda of a single constraint: `weight` is grad C M^-1 grad C^T, `change` grad C . (x - x_n).
template <class T>
T multiplier_step(T c, T lambda, T change, T weight, const Softness<T>& s) {
  return weight > 0 ? (-c - s.alpha * lambda - s.gamma * change) / ((1 + s.gamma) * weight + s.alpha) : T(0);
}

}  // namespace truestep::xpbd
