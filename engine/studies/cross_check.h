// Two computations of one scene side by side: how far they diverge over time, and at what rate,
//   |x_a - x_b|_2 / |x_b|_2 ~ exp(rate t),
// fitted over the part of the path where the difference grows. A positive rate that does not depend on the
// methods belongs to the motion (its largest Lyapunov exponent); a difference that grows like a power of t
// comes from the methods. For rigid bodies it also reports distances of positions (m) and angles (rad), and
// compares quantities like energies and penetrations, which remain comparable when the motion is chaotic.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/studies/study.h"

namespace truestep {

/// What one side changes.
struct CrossCheckSide {
  std::string integrator;
  std::optional<double> dt, tolerance;
  std::string engine;
};

struct CrossCheckParams {
  std::string system, quantity = "state";
  CrossCheckSide a, b;
  std::vector<std::string> statistics;
  std::optional<double> horizon;  ///< s
  int64_t samples = 100;
  double budget = 40;  ///< s
};

const DefTable& cross_check_table();
StudyResult run_cross_check(const boost::json::value& scene, const void* def, StudyContext& context);

}  // namespace truestep
