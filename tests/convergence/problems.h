// Smooth problems with known solutions for order measurements, and the measurement itself: the slope of
// log(error) against log(h) between successive halvings.
#pragma once
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "engine/core/equations/integrator.h"

namespace truestep::test {

/// A force field with the end of its motion: (x, v) at t_end.
struct Problem {
  std::unique_ptr<const ForceField> field;
  double t_end = 1;
  std::vector<double> x_end, v_end;
};

/// m = 1, k = 4, exact.
Problem oscillator();
/// The same with c = 0.6: the acceleration depends on velocity.
Problem damped_oscillator();
/// Two-body motion with eccentricity 0.2 from its near point over 5 time units, exact.
Problem kepler();
/// A free rigid body with three different moments of inertia: orientation quaternion and body-frame angular
/// velocity, q' = 1/2 q (0, w); reference by Gragg's extrapolation of order 8.
Problem free_body();

/// Steps a problem `steps` times; largest error of position and velocity at the end.
double end_error(const Integrator& method, const Problem& problem, size_t steps,
                 const IntegratorOptions& options = {});

/// Observed order: slopes s_k = log2(e(n) / e(2n)) over n, 2n, 4n ... until rounding shares in the error
/// (1e-12), the last two extrapolated to h = 0 (2 s_k - s_{k-1}: the error's second term falls like h).
double observed_order(const std::function<double(size_t steps)>& error, size_t first, size_t doublings);

/// How an order is fitted: over errors below `largest`, where the leading term dominates, and above
/// `smallest`, where rounding is negligible, with the first `terms` of log e = c + p log h + d h + e h^2.
struct Fit {
  double largest = 1e-7, smallest = 1e-12;
  int terms = 3;
};

/// The same for high orders, which leave few halvings above rounding: least squares over step counts that
/// grow by a sixteenth.
double fitted_order(const std::function<double(size_t steps)>& error, const Fit& fit = {});

}  // namespace truestep::test
