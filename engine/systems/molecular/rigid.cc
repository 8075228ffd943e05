// A velocity Verlet step with rigid molecules (kernels/molecular/settle.h), and the langevin step: kick, half
// a drift, friction and noise, half a drift, kick (BAOAB, Leimkuhler and Matthews 2013; with rigid molecules
// 2016), whose positions have errors of order h^2 that vanish in harmonic wells.
#include "engine/integrators/control/last_force.h"
#include "engine/systems/molecular/molecular.h"

namespace truestep::molecular {
namespace {

constexpr size_t kMolecules = 512;

Triangle load(const double* p, const std::array<uint32_t, 3>& w) {
  return {load3(p, w[0]), load3(p, w[1]), load3(p, w[2])};
}

}  // namespace

void Molecular::drift(Motion& m, double h) const {
  const auto& waters = atoms_.start().waters;
  double *x = m.x.data(), *v = m.v.data();
  if (waters.empty()) return m.loop(m.v.size(), [=](size_t k) { x[k] += h * v[k]; });
  const auto old = m.scratch("molecular.old", m.x.size());
  double* before = old.data();
  m.loop(m.v.size(), [=](size_t k) { before[k] = x[k], x[k] += h * v[k]; });
  const WaterShape shape = water_shape(atoms_.def());
  m.input.arena.for_blocks(waters.size(), kMolecules, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      const auto& w = waters[n];
      const Triangle free = load(x, w), put = settle_places(shape, load(before, w), free);
      for (size_t k = 0; k < 3; ++k) {
        store3(x, w[k], put[k]);
        store3(v, w[k], load3<double>(v, w[k]) + (put[k] - free[k]) * (1 / h));
      }
    }
  });
}

void Molecular::settle(Motion& m) const {
  const auto& waters = atoms_.start().waters;
  if (waters.empty()) return;
  const WaterShape shape = water_shape(atoms_.def());
  m.input.arena.for_blocks(waters.size(), kMolecules, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      const Triangle v = settle_velocities(shape, load(m.x.data(), waters[n]), load(m.v.data(), waters[n]));
      for (size_t k = 0; k < 3; ++k) store3(m.v.data(), waters[n][k], v[k]);
    }
  });
}

void Molecular::advance_own(State& s, const StepInput& in) const {
  using Method = ThermostatDef::Method;
  const auto& thermostat = atoms_.def().thermostat;
  Motion m(atoms_, s, in);
  const auto a = m.scratch("integrator.k1", m.v.size());
  LastForce& last = in.workspace.object<LastForce>("integrator.last_force");
  if (!last.holds(m, in.t)) m.acceleration(in.t, m.x, m.v, a);
  const double half = 0.5 * in.h;
  double* v = m.v.data();
  const double* pa = a.data();
  const auto kick = [&] { m.loop(m.v.size(), [=](size_t k) { v[k] += half * pa[k]; }); };
  kick();
  if (thermostat && thermostat->method == Method::langevin) {
    settle(m);
    drift(m, half);
    double heat = add_noise(m);
    if (!atoms_.start().waters.empty()) {
      const double before = kinetic(s, in);
      settle(m);
      heat += kinetic(s, in) - before;
    }
    s.f64(Columns::bath)[static_cast<size_t>(Bath::heat)] += heat;
    drift(m, half);
  } else {
    drift(m, in.h);
  }
  m.acceleration(in.t + in.h, m.x, m.v, a);
  kick();
  settle(m);
  last.keep(m, in.t + in.h);
}

}  // namespace truestep::molecular
