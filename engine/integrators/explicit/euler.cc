// First-order methods with one evaluation per step.
//   euler             x' = x + h G(x) v              v' = v + h a(x, v, t)
//   symplectic_euler  v' = v + h a(x, v, t)          x' = x + h G(x) v'
//   modified_euler    v' = v + h a(x, v, t)          x' = x + h G(x) (v + v') / 2
// Hairer, Lubich, Wanner 2006, "Geometric numerical integration", eqs. I.1.5 and I.1.9; modified_euler is the
// trapezoidal position update that treats a constant acceleration exactly. A second path for the first two
// besides their `advance`, which takes 2.2 times the instructions on a cloth of 9,702 springs, 1.6 times on
// two points (tests/bench/method_paths.cc).
#include "engine/integrators/motion.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

void step_euler(const ForceField& field, State& state, const StepInput& in, const IntegratorOptions&) {
  Motion m(field, state, in);
  const auto a = m.scratch("integrator.k1", m.v.size());
  m.acceleration(in.t, m.x, m.v, a);
  const auto rate = m.rate(in.t, m.x, m.v, m.scratch("integrator.rate", m.x.size()));
  const double h = in.h;
  double *x = m.x.data(), *v = m.v.data();
  const double *pa = a.data(), *pr = rate.data();
  if (pr == v) {
    m.loop(m.v.size(), [=](size_t i) {
      x[i] += h * v[i];
      v[i] += h * pa[i];
    });
  } else {
    m.loop(m.x.size(), [=](size_t i) { x[i] += h * pr[i]; });
    m.loop(m.v.size(), [=](size_t i) { v[i] += h * pa[i]; });
  }
  m.project();
}

void step_symplectic_euler(const ForceField& field, State& state, const StepInput& in,
                           const IntegratorOptions&) {
  Motion m(field, state, in);
  const auto a = m.scratch("integrator.k1", m.v.size());
  m.acceleration(in.t, m.x, m.v, a);
  const double h = in.h;
  double *x = m.x.data(), *v = m.v.data();
  const double* pa = a.data();
  if (m.plain_rate()) {
    m.loop(m.v.size(), [=](size_t i) {
      v[i] += h * pa[i];
      x[i] += h * v[i];
    });
  } else {
    m.loop(m.v.size(), [=](size_t i) { v[i] += h * pa[i]; });
    const double* rate = m.rate(in.t, m.x, m.v, m.scratch("integrator.rate", m.x.size())).data();
    m.loop(m.x.size(), [=](size_t i) { x[i] += h * rate[i]; });
  }
  m.project();
}

void step_modified_euler(const ForceField& field, State& state, const StepInput& in,
                         const IntegratorOptions&) {
  Motion m(field, state, in);
  const auto a = m.scratch("integrator.k1", m.v.size());
  m.acceleration(in.t, m.x, m.v, a);
  const double h = in.h, half = 0.5 * in.h;
  double *x = m.x.data(), *v = m.v.data();
  const double* pa = a.data();
  if (m.plain_rate()) {
    m.loop(m.v.size(), [=](size_t i) {
      const double next = v[i] + h * pa[i];
      x[i] += half * (v[i] + next);
      v[i] = next;
    });
  } else {
    const auto mean = m.scratch("integrator.v", m.v.size());
    double* pm = mean.data();
    m.loop(m.v.size(), [=](size_t i) {
      const double next = v[i] + h * pa[i];
      pm[i] = 0.5 * (v[i] + next);
      v[i] = next;
    });
    const double* rate = m.rate(in.t, m.x, mean, m.scratch("integrator.rate", m.x.size())).data();
    m.loop(m.x.size(), [=](size_t i) { x[i] += h * rate[i]; });
  }
  m.project();
}

}  // namespace truestep
