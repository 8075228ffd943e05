// The minimum of a step's incremental potential (barrier_step.h) by Newton's method.
#pragma once
#include "engine/core/system.h"
#include "engine/math/solvers/block_solver.h"
#include "engine/systems/fem/barrier/barrier_terms.h"
#include "engine/systems/fem/fem_field.h"

namespace truestep::fem {

/// A step in progress; memory belongs to the workspace.
struct BarrierWork {
  State& state;
  const StepInput& in;
  Evaluation e;
  BarrierLaw law;
  double tau = 0;  ///< s, time at which walls are evaluated
  size_t n, all;   ///< coordinates of nodes; of nodes and obstacle corners
  std::span<double> x, x0, push, to, a, v, gradient, d, trial, target;
  std::span<const double> w;  ///< 1/kg
  std::vector<FeaturePair>& pairs;
  std::span<double> ways;  ///< 6 a row: boxes of the paths that pairs were found for
  bool searched = false;
  std::vector<BarrierHessian>& forms;
  std::vector<BarrierTouch>& touches;
  std::vector<FrictionTerm>& friction;
  struct System {
    BlockSparse dfdx, dfdv, a;
    std::vector<BlockSparse::Pair> extra, pattern;
    std::vector<BlockSparse::Slot> slots;  ///< positions of dfdx's blocks in a
    BlockSolver solver;
  };
  System& system;
  double energy = 0, magnitude = 0, least_gap = 0;
  BarrierOutput::Slip slip = BarrierOutput::Slip::exact;
};

/// Share of the gap that must be left after a move.
inline constexpr double kLeftOfGap = 0.2;

/// m, bound on the change of the features' distance along d.
double relative_way(const FeaturePair& pair, std::span<const double> d);

class BarrierNewton {
 public:
  BarrierNewton(const FemField& field, const BarrierSurface& surface) : field_(field), surface_(surface) {}

  /// Finds pairs that may come within reach on the paths from x to x + d. The pairs of an earlier search are
  /// reused while every point stays in the box of its path then, plus some slack.
  void find_pairs(BarrierWork& work, std::span<const double> d) const;
  /// The share of the step d before anything comes into contact; the pairs must be those near it.
  double safe_share(const BarrierWork& work, std::span<const double> d) const;
  /// Throws Instability if no minimum is found.
  void minimise(BarrierWork& work) const;

 private:
  double evaluate(BarrierWork& work, std::span<const double> x, bool slopes) const;
  void direction(BarrierWork& work) const;
  void bend(BarrierWork& work) const;

  const FemField& field_;
  const BarrierSurface& surface_;
};

}  // namespace truestep::fem
