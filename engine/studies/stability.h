// Largest stable step of each method on a scene, found by bisection, beside linear theory:
//   dt <= imaginary limit / omega_max  and  dt <= real limit / damping_max,
// with both rates from a power iteration on the scene's own stiffness (Hairer, Wanner 1996, section IV.2).
// A step is stable when `steps` steps from a slightly disturbed start stay finite and no row goes farther
// than ten times as far as the reference motion does in the same time.
#pragma once
#include <string>
#include <vector>

#include "engine/studies/study.h"

namespace truestep {

struct StabilityParams {
  std::string system;
  std::vector<std::string> integrators;  ///< empty: the explicit fixed-step ones that serve the system
  int64_t steps = 1000;
  double accuracy = 1e-3;  ///< relative width at which the bisection ends
  double budget = 40;      ///< s
};

const DefTable& stability_table();
StudyResult run_stability(const boost::json::value& scene, const void* def, StudyContext& context);

}  // namespace truestep
