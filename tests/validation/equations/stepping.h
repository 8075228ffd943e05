// A force field with one integrator, stepped without a session around it.
#pragma once
#include <array>
#include <cmath>
#include <complex>
#include <memory>

#include "engine/core/equations/integrator.h"
#include "engine/systems/oscillator/oscillator.h"

namespace truestep::test {

/// Adaptive methods take every step as one.
inline constexpr IntegratorOptions kOneInternalStep = {.tolerance = 1e300, .newton_tolerance = 1e-13};

class SteppedField {
 public:
  SteppedField(const ForceField& field, const Integrator& method, double h, IntegratorOptions options = {})
      : field_(field), method_(method), h_(h), options_(options), state(field.initial_state()) {
    if (method.prepare) method.prepare(field, state);
  }
  void steps(uint64_t n) {
    for (uint64_t i = 0; i < n; ++i, ++done_) {
      method_.step(field_, state,
                   {.t = double(done_) * h_, .h = h_, .step = done_, .workspace = workspace, .arena = arena},
                   options_);
    }
  }
  double x(size_t i = 0) const { return state.f64(state.at("position"))[i]; }
  double v(size_t i = 0) const { return state.f64(state.at("velocity"))[i]; }
  double energy() {
    Evaluation e{workspace, arena};
    const Phase at{double(done_) * h_, state.f64(state.at("position")), state.f64(state.at("velocity")),
                   state};
    return field_.kinetic(at, e) + field_.potential(at, e).value_or(0);
  }

 private:
  const ForceField& field_;
  const Integrator& method_;
  double h_;
  IntegratorOptions options_;
  uint64_t done_ = 0;

 public:
  State state;
  Workspace workspace;
  ThreadArena arena{1};
};

/// An oscillator of mass 1 from (x, v).
inline std::unique_ptr<const ForceField> unit_oscillator(double stiffness, double damping, double x,
                                                         double v) {
  oscillator::OscillatorDef d;
  d.stiffness = stiffness, d.damping = damping, d.position = x, d.velocity = v;
  return oscillator::make_oscillator_field(d);
}

/// The linear map (x, v) -> (x, v) of one step, {xx, xv, vx, vv}. Methods with a memory take their first
/// step.
inline std::array<double, 4> step_map(const Integrator& method, double stiffness, double damping, double h,
                                      const IntegratorOptions& options = kOneInternalStep) {
  std::array<double, 4> m;
  for (size_t c = 0; c < 2; ++c) {
    const auto field = unit_oscillator(stiffness, damping, c == 0, c == 1);
    SteppedField run(*field, method, h, options);
    run.steps(1);
    m[c] = run.x(), m[2 + c] = run.v();
  }
  return m;
}

/// Eigenvalue of larger modulus (the one with positive imaginary part of a pair).
inline std::complex<double> dominant_eigenvalue(const std::array<double, 4>& m) {
  const double mean = 0.5 * (m[0] + m[3]), det = m[0] * m[3] - m[1] * m[2];
  const std::complex<double> root = std::sqrt(std::complex<double>(mean * mean - det));
  return std::abs(mean + root) >= std::abs(mean - root) ? mean + root : mean - root;
}

}  // namespace truestep::test
