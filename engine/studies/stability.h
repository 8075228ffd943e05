// Largest step up to which each method holds on a scene, beside linear theory:
//   dt <= imaginary limit / omega_max  and  dt <= real limit / damping_max,
// with both rates from a power iteration on the scene's own stiffness (Hairer, Wanner 1996, section IV.2).
// A step is stable when `steps` steps from a slightly disturbed start stay finite and no row goes farther
// than ten times as far as the reference motion does in the same time. Steps are tried from below: what is
// reported is the end of the first stable span, and beside it the spans above where a method holds again
// (compositions of leapfrog do), which no scene with more than one frequency should rely on.
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
