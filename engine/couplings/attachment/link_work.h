// What links and stiff springs between two systems cost: Newton's method solves for their impulses by
// conjugate gradients, and every iteration asks both sides how they respond.
#pragma once
#include <algorithm>

#include "engine/core/equations/impulse_answer.h"

namespace truestep::attachment {

/// s per pair: kicks at both ends of a substep; sweeps over links whose points respond alone.
inline constexpr double kKickSeconds = 1e-7, kSweepSeconds = 1.5e-6;
/// Newton steps in a substep, as in swinging ropes: those for the directions, those that close lengths.
inline constexpr double kDirections = 4, kClosings = 3;
/// Iterations that reach the accuracy, whatever the number of directions in which pairs pull.
inline constexpr double kMostAsked = 30;

/// Answers asked for by one solution for pairs that pull in so many directions.
inline double asked(double directions) {
  return std::min(directions, kMostAsked) + 1;
}

}  // namespace truestep::attachment
