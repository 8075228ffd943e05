// Methods that divide a session's step into as many internal steps as the tolerance asks for, and never step
// over its end. The next internal step and the last error live in the state, so a restored run repeats
// every choice.
//   step_doubling  one rk4 step of T against two of T/2: e = |x_{T/2} - x_T|; redone with a smaller T while e
//                  exceeds the tolerance, else x = x_{T/2} + (x_{T/2} - x_T) / 15 (local extrapolation,
//                  order 5). Hairer, Norsett, Wanner 1993, eqs. II.4.3 to II.4.5.
//   dopri5         the embedded error of order 4; proportional-integral control of the step, Gustafsson 1991,
//                  "Control theoretic techniques for stepsize selection", as in Hairer and Wanner's section
//                  IV.2. The last stage is the next internal step's first; across session steps it is
//                  evaluated again, because commands may have changed anything.
// The tolerance bounds the largest component of the error in x and in v, in their own units.
#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/integrators/methods.h"
#include "engine/integrators/runge_kutta.h"
#include "engine/math/trig.h"

namespace truestep {

namespace {

constexpr std::string_view kInternalStep = "integrator.internal_step";
constexpr std::string_view kLastError = "integrator.last_error";

[[noreturn]] void give_up(const Motion& m, double t, double h) {
  const auto bad = m.state.first_non_finite();
  throw Instability("", "position", bad ? static_cast<long long>(bad->row) : -1,
                    "the tolerance cannot be met at t = " + std::to_string(t) +
                        " s: the internal step fell to " + std::to_string(h) + " s");
}

// The larger one, or NaN when one is NaN (fmax would drop it).
double worse(double a, double b) {
  return a > b || a != a ? a : b;
}

// Runs attempts over [0, input.h]. attempt(t, h) leaves a candidate and returns its error over the tolerance;
// accept(h) takes it. `control(error, last error)` is the factor for the next step.
template <class Attempt, class Accept, class Control>
void subdivide(Motion& m, Attempt attempt, Accept accept, Control control) {
  const double length = m.input.h;
  const auto column = m.state.at(kInternalStep), error_column = m.state.at(kLastError);
  double h = m.state.f64(column)[0], last_error = m.state.f64(error_column)[0];
  if (!(h > 0)) h = length, last_error = 1e-4;
  double done = 0;
  bool rejected = false;
  for (;;) {
    const double left = length - done;
    const bool last = h >= left * (1 - 1e-12);
    // Less than two steps left: two equal ones, so that no sliver remains.
    const double now = last ? left : 2 * h > left ? 0.5 * left : h;
    const double error = attempt(m.input.t + done, now);
    if (!(error <= 1)) {
      h = now * (std::isfinite(error) ? std::clamp(0.9 * trig::pow(error, -0.2), 0.1, 0.9) : 0.1);
      rejected = true;
      if (h < 1e-9 * length) give_up(m, m.input.t + done, h);
      continue;
    }
    accept(now);
    const double factor = std::clamp(control(error, last_error), 0.2, rejected ? 1.0 : 10.0);
    h = now < h ? std::max(h, now * factor) : now * factor;
    last_error = std::max(error, 1e-4);
    rejected = false;
    if (last) break;
    done += now;
  }
  m.state.f64(column)[0] = std::min(h, length);
  m.state.f64(error_column)[0] = last_error;
}

}  // namespace

void prepare_adaptive(const ForceField&, State& s) {
  s.add({std::string(kInternalStep), "s", Scalar::f64, 1, Role::internal}, 1);
  s.add({std::string(kLastError), "1", Scalar::f64, 1, Role::internal}, 1);
}

void step_step_doubling(const ForceField& field, State& state, const StepInput& in,
                        const IntegratorOptions& options) {
  Motion m(field, state, in);
  RungeKutta rk(kRk4Tableau, m);
  const size_t nx = m.x.size(), nv = m.v.size();
  const auto x_full = m.scratch("integrator.x_full", nx), v_full = m.scratch("integrator.v_full", nv);
  const auto x_half = m.scratch("integrator.x_half", nx), v_half = m.scratch("integrator.v_half", nv);
  const auto difference = [](std::span<double> fine, std::span<double> coarse) {
    Combination t;
    t.add(1, fine.data());
    t.add(-1, coarse.data());
    return t;
  };
  const auto attempt = [&](double t, double h) {
    rk.step(t, h, m.x, m.v, x_full, v_full);
    // The first stage of the first half is that of the whole.
    rk.step(t, 0.5 * h, m.x, m.v, x_half, v_half, 1);
    rk.step(t + 0.5 * h, 0.5 * h, x_half, v_half, x_half, v_half);
    return worse(largest(m, nx, difference(x_half, x_full)), largest(m, nv, difference(v_half, v_full))) /
           options.tolerance;
  };
  const auto accept = [&](double) {
    const auto extrapolate = [&m](std::span<double> out, std::span<double> fine, std::span<double> coarse) {
      double* o = out.data();
      const double *f = fine.data(), *c = coarse.data();
      m.loop(out.size(), [=](size_t i) { o[i] = f[i] + (f[i] - c[i]) * (1.0 / 15); });
    };
    extrapolate(m.x, x_half, x_full);
    extrapolate(m.v, v_half, v_full);
  };
  subdivide(m, attempt, accept,
            [](double error, double) { return error > 0 ? 0.9 * trig::pow(error, -0.2) : 10.0; });
  m.project();
}

void step_dopri5(const ForceField& field, State& state, const StepInput& in,
                 const IntegratorOptions& options) {
  // b - b^, of which only the sum of products with the stages matters.
  static constexpr Tableau::Weights kError = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                              -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
  Motion m(field, state, in);
  RungeKutta rk(kDopri5Tableau, m);
  bool first_stands = false;
  const auto attempt = [&](double t, double h) {
    for (size_t i = first_stands ? 1 : 0; i < kDopri5Tableau.stages; ++i) rk.stage(i, t, h, m.x, m.v);
    first_stands = true;
    return worse(largest(m, m.x.size(), rk.position_terms(h, kError, m.v)),
                 largest(m, m.v.size(), rk.velocity_terms(h, kError))) /
           options.tolerance;
  };
  const auto accept = [&](double h) {
    // Position first: its terms contain the old velocity.
    combine(m, m.x.size(), m.x.data(), m.x.data(), rk.position_terms(h, kDopri5Tableau.b, m.v));
    combine(m, m.v.size(), m.v.data(), m.v.data(), rk.velocity_terms(h, kDopri5Tableau.b));
    rk.last_stage_becomes_first();
  };
  subdivide(m, attempt, accept, [](double error, double last) {
    return error > 0 ? 0.9 * trig::pow(error, -0.17) * trig::pow(last, 0.04) : 10.0;
  });
  m.project();
}

}  // namespace truestep
