// Boost.odeint as its users call it: controlled steppers on std::vector, rosenbrock4 with dense output on
// uBLAS. A right-hand side that is called too often ends the run: with coarse tolerances bodies collide.
#pragma once
#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4_controller.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4_dense_output.hpp>
#include <boost/numeric/ublas/matrix.hpp>
#include <boost/numeric/ublas/vector.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "tests/bench/ode/problems.h"

namespace truestep::bench {

inline constexpr uint64_t kMostEvaluations = 20'000'000;

/// Stepper: an explicit error stepper on Vector.
template <class Stepper, class F>
Solver odeint_explicit(const char* name, const F& f, const Case& at, int from, int to) {
  const auto run = [&f, &at](double tolerance) -> Outcome {
    Outcome out{.end = at.start};
    const auto rate = [&](const Vector& y, Vector& d, double t) {
      if (++out.evaluations > kMostEvaluations) throw std::runtime_error("too many evaluations");
      f.rate(t, y.data(), d.data());
    };
    try {
      using namespace boost::numeric::odeint;
      integrate_adaptive(make_controlled(tolerance * at.absolute_scale, tolerance, Stepper()), rate, out.end,
                         0.0, at.t_end, at.first_step);
    } catch (const std::runtime_error&) {
      return {};
    }
    return out;
  };
  return {.name = name, .side = "odeint", .from = from, .to = to, .run = run};
}

template <class F>
Solver odeint_dopri5(const F& f, const Case& at, int from, int to) {
  using Stepper = boost::numeric::odeint::runge_kutta_dopri5<Vector>;
  return odeint_explicit<Stepper>("odeint dopri5", f, at, from, to);
}

template <class F>
Solver odeint_fehlberg78(const F& f, const Case& at, int from, int to) {
  using Stepper = boost::numeric::odeint::runge_kutta_fehlberg78<Vector>;
  return odeint_explicit<Stepper>("odeint fehlberg78", f, at, from, to);
}

/// With the problem's Jacobian, or forward differences where it has none.
template <class F>
Solver odeint_rosenbrock4(const F& f, const Case& at, int from, int to) {
  namespace ublas = boost::numeric::ublas;
  using State = ublas::vector<double>;
  const auto run = [&f, &at](double tolerance) -> Outcome {
    const size_t n = at.start.size();
    const RightHandSide& derivatives = f;
    Outcome out;
    State y(n), moved(n), moved_rate(n), base(n);
    std::copy(at.start.begin(), at.start.end(), y.begin());
    Vector values(n * n);
    const auto rate = [&](const State& x, State& d, double t) {
      if (++out.evaluations > kMostEvaluations) throw std::runtime_error("too many evaluations");
      f.rate(t, &x[0], &d[0]);
    };
    const auto jacobian = [&](const State& x, ublas::matrix<double>& j, double t, State& time) {
      std::fill(time.begin(), time.end(), 0.0);
      if (derivatives.has_jacobian()) {
        derivatives.jacobian(t, &x[0], values.data());
        for (size_t i = 0; i < n; ++i)
          for (size_t c = 0; c < n; ++c) j(i, c) = values[c * n + i];
        return;
      }
      rate(x, base, t);
      moved = x;
      for (size_t c = 0; c < n; ++c) {
        const double h = std::sqrt(std::numeric_limits<double>::epsilon()) * std::max(1e-5, std::abs(x[c]));
        moved[c] = x[c] + h;
        rate(moved, moved_rate, t);
        for (size_t i = 0; i < n; ++i) j(i, c) = (moved_rate[i] - base[i]) / h;
        moved[c] = x[c];
      }
      if (derivatives.autonomous()) return;
      const double h = 1e-7;
      rate(x, moved_rate, t + h);
      for (size_t i = 0; i < n; ++i) time[i] = (moved_rate[i] - base[i]) / h;
    };
    try {
      using namespace boost::numeric::odeint;
      integrate_adaptive(make_dense_output<rosenbrock4<double>>(tolerance * at.absolute_scale, tolerance),
                         std::make_pair(rate, jacobian), y, 0.0, at.t_end, at.first_step);
    } catch (const std::runtime_error&) {
      return {};
    }
    out.end.assign(y.begin(), y.end());
    return out;
  };
  return {.name = "odeint rosenbrock4", .side = "odeint", .from = from, .to = to, .run = run};
}

}  // namespace truestep::bench
