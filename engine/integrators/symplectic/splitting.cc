// Compositions of drifts (x moves with constant v) and kicks (v changes at constant x), symplectic for
// forces that depend on position only (splitting.h).
//   velocity_verlet  kick h/2, drift h, kick h/2          leapfrog  drift h/2, kick h, drift h/2
// Swope et al. 1982 (velocity Verlet); Hairer, Lubich, Wanner 2006, section I.1.4. If the acceleration
// depends on velocity, a kick first predicts the velocity it is evaluated at, which keeps order 2; a
// composition of such leapfrogs still cancels the h^3 error but, since these are no longer self-adjoint, not
// the h^4 error: order 3. The last evaluation of velocity_verlet is the next step's first, unless a command
// or a collision changed anything in between: last_force.h keeps it as long as every bit it depends on is
// unchanged. A second path besides advance_splitting.cc, which takes 1.1 to 2.2 times the instructions on a
// cloth of 9,702 springs and handles only points (tests/bench/method_paths.cc).
#include "engine/integrators/symplectic/splitting.h"
#include "engine/integrators/control/last_force.h"
#include "engine/integrators/motion.h"
#include "engine/integrators/table/methods.h"

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

// v changes by h times the acceleration at (x, v + h/2 a), or a itself if it does not depend on velocity.
// With plain rates the following drift shares the pass.
void kick_then_drift(Motion& m, double t, double h, double drift_h) {
  const size_t n = m.v.size();
  const auto a = m.scratch("integrator.k1", n);
  const double* pa = a.data();
  m.acceleration(t, m.x, m.v, a);
  if (m.field.dependence() == Dependence::position_and_velocity) {
    const auto predicted = m.scratch("integrator.v", n);
    double* p = predicted.data();
    const double* v = m.v.data();
    const double half = 0.5 * h;
    m.loop(n, [=](size_t i) { p[i] = v[i] + half * pa[i]; });
    m.acceleration(t, m.x, predicted, a);
  }
  double *x = m.x.data(), *v = m.v.data();
  if (m.plain_rate()) {
    m.loop(n, [=](size_t i) {
      v[i] += h * pa[i];
      x[i] += drift_h * v[i];
    });
  } else {
    m.loop(n, [=](size_t i) { v[i] += h * pa[i]; });
    drift(m, t, drift_h);
  }
}

void step_splitting(const Splitting& s, const ForceField& field, State& state, const StepInput& in) {
  Motion m(field, state, in);
  double place = s.drift[0];  // of x in the step
  drift(m, in.t, s.drift[0] * in.h);
  for (size_t i = 0; i < s.kicks; ++i) {
    kick_then_drift(m, in.t + place * in.h, s.kick[i] * in.h, s.drift[i + 1] * in.h);
    place += s.drift[i + 1];
  }
  m.project();
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

void step_leapfrog(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions&) {
  step_splitting(kLeapfrog, f, s, in);
}
void step_yoshida4(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions&) {
  step_splitting(kYoshida4, f, s, in);
}
void step_yoshida6(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions&) {
  step_splitting(kYoshida6, f, s, in);
}
void step_yoshida8(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions&) {
  step_splitting(kYoshida8, f, s, in);
}
void step_kahan_li8(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions&) {
  step_splitting(kKahanLi8, f, s, in);
}
void step_pefrl(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions&) {
  step_splitting(kPefrl, f, s, in);
}

}  // namespace truestep
