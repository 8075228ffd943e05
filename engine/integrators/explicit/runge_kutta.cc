#include "engine/integrators/explicit/runge_kutta.h"

#include <algorithm>
#include <utility>

#include "engine/integrators/table/methods.h"

namespace truestep {

namespace {
constexpr std::array<std::string_view, Tableau::kMaxStages> kAccelerationKeys = {
    "integrator.k1",  "integrator.k2",  "integrator.k3", "integrator.k4", "integrator.k5",
    "integrator.k6",  "integrator.k7",  "integrator.k8", "integrator.k9", "integrator.k10",
    "integrator.k11", "integrator.k12", "integrator.k13"};
constexpr std::array<std::string_view, Tableau::kMaxStages> kRateKeys = {
    "integrator.r1",  "integrator.r2",  "integrator.r3", "integrator.r4", "integrator.r5",
    "integrator.r6",  "integrator.r7",  "integrator.r8", "integrator.r9", "integrator.r10",
    "integrator.r11", "integrator.r12", "integrator.r13"};
}  // namespace

RungeKutta::RungeKutta(const Tableau& tableau, Motion& motion)
    : tableau_(tableau), motion_(motion), plain_(motion.plain_rate()) {
  for (size_t i = 0; i < tableau.stages; ++i) {
    k_[i] = motion.scratch(kAccelerationKeys[i], motion.v.size()).data();
    if (!plain_) rate_[i] = motion.scratch(kRateKeys[i], motion.x.size()).data();
  }
}

Combination RungeKutta::position_terms(double h, const Weights& w, std::span<const double> v) const {
  Combination t;
  if (plain_) {
    double weight_of_v = 0;
    Weights nystrom{};
    for (size_t j = 0; j < tableau_.stages; ++j) {
      weight_of_v += w[j];
      for (size_t l = 0; l < j; ++l) nystrom[l] += w[j] * tableau_.a[j][l];
    }
    t.add(h * weight_of_v, v.data());
    for (size_t j = 0; j < tableau_.stages; ++j) t.add(h * h * nystrom[j], k_[j]);
  } else {
    for (size_t j = 0; j < tableau_.stages; ++j) t.add(h * w[j], rate_[j]);
  }
  return t;
}

Combination RungeKutta::velocity_terms(double h, const Weights& w) const {
  Combination t;
  for (size_t j = 0; j < tableau_.stages; ++j) t.add(h * w[j], k_[j]);
  return t;
}

void RungeKutta::stage(size_t i, double t, double h, std::span<const double> x, std::span<const double> v) {
  std::span<const double> xs = x, vs = v;
  if (i > 0) {
    const auto x_stage = motion_.scratch("integrator.x", x.size());
    combine(motion_, x.size(), x_stage.data(), x.data(), position_terms(h, tableau_.a[i], v));
    xs = x_stage;
    if (!plain_ || motion_.field.dependence() == Dependence::position_and_velocity) {
      const auto v_stage = motion_.scratch("integrator.v", v.size());
      combine(motion_, v.size(), v_stage.data(), v.data(), velocity_terms(h, tableau_.a[i]));
      vs = v_stage;
    }
  }
  const double t_stage = t + tableau_.c[i] * h;
  motion_.acceleration(t_stage, xs, vs, {k_[i], v.size()});
  if (!plain_) {
    const std::span<double> out{rate_[i], x.size()};
    const auto rate = motion_.rate(t_stage, xs, vs, out);
    if (rate.data() != out.data()) std::copy(rate.begin(), rate.end(), out.begin());
  }
}

void RungeKutta::step(double t, double h, std::span<const double> x, std::span<const double> v,
                      std::span<double> x_out, std::span<double> v_out) {
  for (size_t i = 0; i < tableau_.stages; ++i) stage(i, t, h, x, v);
  combine(motion_, x.size(), x_out.data(), x.data(), position_terms(h, tableau_.b, v));
  combine(motion_, v.size(), v_out.data(), v.data(), velocity_terms(h, tableau_.b));
}

namespace {
void fixed_step(const Tableau& tableau, const ForceField& field, State& state, const StepInput& in) {
  Motion m(field, state, in);
  RungeKutta(tableau, m).step(in.t, in.h, m.x, m.v, m.x, m.v);
  m.project();
}
}  // namespace

void step_midpoint(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions&) {
  fixed_step(kMidpointTableau, f, s, in);
}
void step_heun(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions&) {
  fixed_step(kHeunTableau, f, s, in);
}
void step_rk4(const ForceField& f, State& s, const StepInput& in, const IntegratorOptions&) {
  fixed_step(kRk4Tableau, f, s, in);
}

}  // namespace truestep
