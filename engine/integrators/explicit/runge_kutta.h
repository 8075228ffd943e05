// Steps of explicit Runge-Kutta methods (tableau.h) on force fields. For dx/dt = G(x) v, dv/dt = a(x, v, t)
// with stages
//   X_i = x + h sum_j a_ij G(X_j) V_j,  V_i = v + h sum_j a_ij K_j,  K_i = a(X_i, V_i, t + c_i h).
// Where G is the identity, inserting V_j into X_i leaves only the K_j (Nystrom's form of the same method;
// Hairer, Norsett, Wanner 1993, "Solving ordinary differential equations I", eqs. II.14.2 to II.14.4):
//   X_i = x + h c_i v + h^2 sum_j (A^2)_ij K_j.
// This reads half as many arrays. A second path besides advance_fixed (advance_pairs.cc), for fixed-step
// methods: that one took 42 to 72 % more instructions on a cloth of 9,702 springs, though 0 to 17 % fewer on
// two points (tests/bench/method_paths.cc); adaptive pairs gain nothing from it.
#pragma once
#include <array>

#include "engine/integrators/explicit/combine.h"
#include "engine/integrators/explicit/tableau.h"
#include "engine/integrators/motion.h"

namespace truestep {

/// Evaluates the stages of a step of length h from (x, v) at time t, leaving the K_i (and the rates G(X_i)
/// V_i if G is not the identity) in the workspace; then writes x + h sum b_i ... to (x_out, v_out), which may
/// be x and v.
class RungeKutta {
 public:
  using Weights = Tableau::Weights;

  RungeKutta(const Tableau& tableau, Motion& motion);
  void step(double t, double h, std::span<const double> x, std::span<const double> v, std::span<double> x_out,
            std::span<double> v_out);

 private:
  /// Evaluates stage `i` alone; stages 0 ... i-1 must be available.
  void stage(size_t i, double t, double h, std::span<const double> x, std::span<const double> v);
  /// The terms of h sum_i w_i (rate of x, rate of v) over the available stages.
  Combination position_terms(double h, const Weights& w, std::span<const double> v) const;
  Combination velocity_terms(double h, const Weights& w) const;

  const Tableau& tableau_;
  Motion& motion_;
  bool plain_;
  std::array<double*, Tableau::kMaxStages> k_{}, rate_{};
};

}  // namespace truestep
