// Compositions of drifts (x moves with constant v) and kicks (v changes at constant x), symplectic for
// forces that depend on position only.
//   velocity_verlet  kick h/2, drift h, kick h/2          leapfrog  drift h/2, kick h, drift h/2
//   yoshida4         leapfrog over w1 h, w0 h, w1 h with w1 = 1 / (2 - 2^(1/3)), w0 = 1 - 2 w1
// Swope et al. 1982 (velocity Verlet); Hairer, Lubich, Wanner 2006, section I.1.4; Yoshida 1990,
// "Construction of higher order symplectic integrators", eq. 2.13.
// Where the acceleration depends on velocity, a kick first predicts the velocity it is evaluated at, which
// keeps order 2; a composition of three such leapfrogs still cancels the h^3 error but, no longer being its
// own adjoint, not the h^4 error: order 3.
// The last evaluation of velocity_verlet is the next step's first, unless a command or a collision changed
// anything in between: last_force.h keeps it as long as every bit that it depends on stays the same.
#include "engine/integrators/last_force.h"
#include "engine/integrators/methods.h"
#include "engine/integrators/motion.h"

namespace truestep {

namespace {

// x' = G(x) v over h with constant v: exact for points, otherwise one rk4 step, so that no order is lost.
void drift(Motion& m, double t, double h) {
  double* x = m.x.data();
  const size_t n = m.x.size();
  const auto r1 = m.rate(t, m.x, m.v, m.scratch("integrator.r1", n));
  if (r1.data() == m.v.data()) {
    const double* v = m.v.data();
    m.loop(n, [=](size_t i) { x[i] += h * v[i]; });
    return;
  }
  const auto xs = m.scratch("integrator.x", n);
  double* px = xs.data();
  const auto move_stage = [&](double step, const double* rate) {
    m.loop(n, [=](size_t i) { px[i] = x[i] + step * rate[i]; });
  };
  const double* k1 = r1.data();
  move_stage(0.5 * h, k1);
  const double* k2 = m.rate(t, xs, m.v, m.scratch("integrator.r2", n)).data();
  move_stage(0.5 * h, k2);
  const double* k3 = m.rate(t, xs, m.v, m.scratch("integrator.r3", n)).data();
  move_stage(h, k3);
  const double* k4 = m.rate(t, xs, m.v, m.scratch("integrator.r4", n)).data();
  const double w = h / 6;
  m.loop(n, [=](size_t i) { x[i] += w * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]); });
}

// Drift h/2, kick h, drift h/2.
void drift_kick_drift(Motion& m, double t, double h) {
  const size_t n = m.v.size();
  const auto a = m.scratch("integrator.k1", n);
  const double* pa = a.data();
  const double half = 0.5 * h;
  drift(m, t, half);
  m.acceleration(t + half, m.x, m.v, a);
  if (m.field.dependence() == Dependence::position_and_velocity) {
    const auto predicted = m.scratch("integrator.v", n);
    double* p = predicted.data();
    const double* v = m.v.data();
    m.loop(n, [=](size_t i) { p[i] = v[i] + half * pa[i]; });
    m.acceleration(t + half, m.x, predicted, a);
  }
  double *x = m.x.data(), *v = m.v.data();
  if (m.plain_rate()) {
    m.loop(n, [=](size_t i) {
      v[i] += h * pa[i];
      x[i] += half * v[i];
    });
  } else {
    m.loop(n, [=](size_t i) { v[i] += h * pa[i]; });
    drift(m, t + half, half);
  }
}

}  // namespace

void step_velocity_verlet(const ForceField& field, State& state, const StepInput& in,
                          const IntegratorOptions&) {
  Motion m(field, state, in);
  const size_t n = m.v.size();
  const auto a = m.scratch("integrator.k1", n);
  double *x = m.x.data(), *v = m.v.data(), *pa = a.data();
  const double h = in.h, half = 0.5 * in.h;
  LastForce& last = in.workspace.object<LastForce>("integrator.last_force");
  if (!last.holds(m, in.t)) m.acceleration(in.t, m.x, m.v, a);
  if (m.plain_rate()) {
    m.loop(n, [=](size_t i) {
      v[i] += half * pa[i];
      x[i] += h * v[i];
    });
  } else {
    m.loop(n, [=](size_t i) { v[i] += half * pa[i]; });
    drift(m, in.t, h);
  }
  std::span<const double> v_at = m.v;
  if (field.dependence() == Dependence::position_and_velocity) {
    const auto predicted = m.scratch("integrator.v", n);
    double* p = predicted.data();
    m.loop(n, [=](size_t i) { p[i] = v[i] + half * pa[i]; });
    v_at = predicted;
  }
  // The next step's own t, to the bit.
  const double t_end = double(in.step + 1) * h;
  m.acceleration(t_end, m.x, v_at, a);
  m.loop(n, [=](size_t i) { v[i] += half * pa[i]; });
  m.project();
  last.keep(m, t_end);
}

void step_leapfrog(const ForceField& field, State& state, const StepInput& in, const IntegratorOptions&) {
  Motion m(field, state, in);
  drift_kick_drift(m, in.t, in.h);
  m.project();
}

void step_yoshida4(const ForceField& field, State& state, const StepInput& in, const IntegratorOptions&) {
  constexpr double kW1 = 1.35120719195965763404768780897, kW0 = -1.70241438391931526809537561794;
  Motion m(field, state, in);
  drift_kick_drift(m, in.t, kW1 * in.h);
  drift_kick_drift(m, in.t + kW1 * in.h, kW0 * in.h);
  drift_kick_drift(m, in.t + (kW1 + kW0) * in.h, kW1 * in.h);
  m.project();
}

}  // namespace truestep
