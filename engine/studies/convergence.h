// Observed order of a method on a scene, or of a system in space (refinement.h): errors against a reference,
// at steps or spacings halved repeatedly, and
//   p_j = log2(e_j / e_{j+1}).
// An order is quoted only when it has settled: the last three p_j that lie above the reference's floor differ
// by less than a tenth (Roache 1998, "Verification and validation in computational science and engineering",
// ch. 5).
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/studies/refinement/refinement.h"
#include "engine/studies/study.h"

namespace truestep {

struct ConvergenceParams {
  std::string system, quantity = "state";
  std::string integrator;           ///< empty: the scene's own
  std::optional<double> step;       ///< s, the largest; default 8 times the scene's
  std::optional<double> horizon;    ///< s
  std::optional<int64_t> halvings;  ///< 7 in time, 4 in space and both
  Refine refine = Refine::time;
  double budget = 40;  ///< s
};

const DefTable& convergence_table();
StudyResult run_convergence(const boost::json::value& scene, const void* def, StudyContext& context);

/// The order to which errors at steps h, h/2, h/4 ... settle, or why there is none to quote.
struct ObservedOrder {
  std::vector<double> per_halving;  ///< NaN where an error is not finite or lies below the floor
  std::optional<double> settled;
  std::optional<double>
      mean;            ///< over all of at least three halvings, for orders that discontinuities scatter
  std::string reason;  ///< why no order was found
};
ObservedOrder observed_order(const std::vector<double>& errors, double floor);

}  // namespace truestep
