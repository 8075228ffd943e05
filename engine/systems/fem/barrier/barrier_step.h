// A step of implicit Euler in which nothing ever touches: x is the minimum of the incremental potential
//   phi(x) = 1/2 |x - x0 - h v0|^2_M + h^2 (V(x) + h R((x - x0) / h) + kappa sum b(gap) + friction)
// by Newton's method, whose line search stops before any two features meet on their straight paths (Li et al.
// 2020, "Incremental potential contact"; paths by conservative advancement). Obstacles and held nodes move
// first, as far as they can without touching; the rest then yields, and the two alternate until obstacles and
// held nodes have reached their targets. A step in which features would pass each other by more than an edge
// is subdivided. No data is carried over between steps.
#pragma once
#include "engine/systems/fem/barrier/barrier_newton.h"

namespace truestep::fem {

class BarrierStep {
 public:
  BarrierStep(const FemField& field, BarrierSurface surface, double reach);

  /// Instability when a body is crushed between obstacles or held nodes.
  void step(State& state, const StepInput& input) const;

  struct Report {
    double least_gap = 0;  ///< m; `reach` where all gaps are larger
    size_t touching = 0;   ///< pairs within reach
    double energy = 0;     ///< J, of the barriers
  };
  Report report(const State& state, double t) const;
  double reach() const { return law_.reach; }
  const BarrierSurface& surface() const { return surface_; }

 private:
  BarrierLaw law_in(const State& state, double h, double overshoot) const;
  double overshoot(const State& state, const StepInput& input) const;
  void advance(State& state, const StepInput& input, double overshoot) const;
  double move_prescribed(BarrierWork& work) const;

  const FemField& field_;
  BarrierSurface surface_;
  BarrierLaw law_;
  double size_ = 0;  // m, size of the body
  double mean_ = 0;  // kg, mean mass of a node
};

}  // namespace truestep::fem
