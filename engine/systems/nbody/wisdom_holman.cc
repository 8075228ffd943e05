#include "engine/systems/nbody/wisdom_holman.h"

#include "engine/kernels/gravity/kepler_motion.h"
#include "engine/systems/nbody/nbody_state.h"

namespace truestep::nbody {

namespace {

/// Positions relative to the centre of mass of the preceding bodies; row 0 is the centre of mass of all. In
/// and out: n x 3.
void to_jacobi(std::span<const double> mass, const double* in, double* out) {
  Vec3 sum = load3(in, 0) * mass[0];
  double eta = mass[0];
  for (size_t i = 1; i < mass.size(); ++i) {
    const Vec3 x = load3(in, i);
    store3(out, i, x - sum / eta);
    sum += x * mass[i], eta += mass[i];
  }
  store3(out, 0, sum / eta);
}

void from_jacobi(std::span<const double> mass, double total, const double* in, double* out) {
  Vec3 center = load3(in, 0);
  double eta = total;
  for (size_t i = mass.size() - 1; i > 0; --i) {
    const Vec3 x = load3(in, i);
    // Centre of mass of those up to i; that of those before i is closer to it by i's share.
    center -= x * (mass[i] / eta);
    store3(out, i, center + x);
    eta -= mass[i];
  }
  store3(out, 0, center);
}

void wisdom_holman_step(const ForceField& field, State& s, const StepInput& in, const IntegratorOptions&) {
  const auto mass = s.f64(Columns::mass);
  const auto x = s.f64(Columns::position), v = s.f64(Columns::velocity);
  const size_t n = mass.size();
  const double g = parameter(s, Parameter::gravitational_constant);
  double total = 0;
  for (const double m : mass) total += m;
  const auto scratch = [&](const char* key) { return in.workspace.doubles(key, 3 * n).first(3 * n); };
  const auto jx = scratch("nbody.jacobi.x"), jv = scratch("nbody.jacobi.v"), a = scratch("nbody.jacobi.a"),
             ja = scratch("nbody.jacobi.ja");

  const auto drift = [&](double h) {
    store3(jx.data(), 0, load3(jx.data(), 0) + load3(jv.data(), 0) * h);
    double eta = mass[0];
    for (size_t i = 1; i < n; ++i) {
      eta += mass[i];
      Vec3 xi = load3(jx.data(), i), vi = load3(jv.data(), i);
      gravity::kepler_motion(xi, vi, g * eta, h);
      store3(jx.data(), i, xi), store3(jv.data(), i, vi);
    }
  };
  to_jacobi(mass, x.data(), jx.data()), to_jacobi(mass, v.data(), jv.data());
  drift(0.5 * in.h);
  from_jacobi(mass, total, jx.data(), x.data()), from_jacobi(mass, total, jv.data(), v.data());
  Evaluation e{in.workspace, in.arena};
  field.acceleration({in.t + 0.5 * in.h, x, v, s}, a, e);
  to_jacobi(mass, a.data(), ja.data());
  double eta = mass[0];
  for (size_t i = 0; i < n; ++i) {
    Vec3 kick = load3(ja.data(), i);
    if (i > 0) {
      eta += mass[i];
      const Vec3 xi = load3(jx.data(), i);
      const double r2 = norm2(xi);
      if (r2 > 0) kick += xi * (g * eta / (r2 * std::sqrt(r2)));
    }
    store3(jv.data(), i, load3(jv.data(), i) + kick * in.h);
  }
  drift(0.5 * in.h);
  from_jacobi(mass, total, jx.data(), x.data()), from_jacobi(mass, total, jv.data(), v.data());
}

}  // namespace

const Integrator& wisdom_holman() {
  static const Integrator kRow{.name = kWisdomHolmanName,
                               .title = "Wisdom and Holman's splitting in Jacobi coordinates",
                               .order = 2,
                               .imaginary_limit = std::numeric_limits<double>::quiet_NaN(),
                               .real_limit = std::numeric_limits<double>::quiet_NaN(),
                               .structure = Integrator::Structure::symplectic,
                               .equations = Integrator::Equations::second_order,
                               .source = "Wisdom, Holman 1991, Astron. J. 102:1528; Rein, Tamayo 2015",
                               .step = wisdom_holman_step};
  return kRow;
}

}  // namespace truestep::nbody
