// Largest stable step of each method on a scene, compared with linear theory:
//   dt <= imaginary limit / omega_max  and  dt <= real limit / damping_max,
// with both rates from a power iteration on the scene's own stiffness (Hairer, Wanner 1996, section IV.2). A
// step is stable when `steps` steps from a slightly disturbed start stay finite and gain no energy that
// carries a row more than ten times as far as in the reference motion in the same time. Steps are tried from
// below: the result is the end of the first stable span, and any spans above where a method is stable again
// (compositions of leapfrog do), which no scene with more than one frequency should rely on.
#pragma once
#include <string>
#include <vector>

#include "engine/studies/study.h"

namespace truestep {

struct StabilityParams {
  std::string system;
  std::vector<std::string> integrators;  ///< empty: the explicit fixed-step methods that serve the system
  int64_t steps = 1000;
  double accuracy = 1e-3;  ///< relative width at which the bisection ends
  double budget = 40;      ///< s
};

const DefTable& stability_table();
StudyResult run_stability(const boost::json::value& scene, const void* def, StudyContext& context);

}  // namespace truestep
