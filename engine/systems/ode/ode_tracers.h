// Points carried by a velocity field v(x, y, z, t): a fixed-step Runge-Kutta method over blocks of points,
// each block's right-hand sides in SIMD lanes, blocks over threads. The states of the system, on which the
// field may depend, are taken at the stages' times.
#pragma once
#include <array>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/systems/ode/ode_model.h"

namespace truestep::ode {

/// Initial positions of tracers, 3 numbers each, m.
std::vector<double> tracer_positions(const TracersDef& def, uint64_t seed);

/// Parameters and states (null when there are none) at the step's start, middle and end.
struct OdeSurroundings {
  double t, h;
  std::span<const double> parameters;
  std::array<const double*, 3> states;
};

/// Moves all points by one step.
void move_tracers(const OdeModel& model, TracersDef::Method method, const OdeSurroundings& at,
                  std::span<double> positions, const ThreadArena& arena);

}  // namespace truestep::ode
