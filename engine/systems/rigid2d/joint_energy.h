// Energy in the joints of a state: what their springs store, and whether any joint can add energy.
#pragma once
#include "engine/systems/rigid2d/columns.h"

namespace truestep::rigid2d {

/// Energy in J of the springs of unbroken joints, sum of k s^2 / 2; where a frequency is given, k is its
/// value at t = 0.
double spring_energy(const Model& model, const State& s);

/// Largest distance (m) of two points that an unbroken joint keeps together.
double widest_gap(const Model& model, const State& s);

/// True where a joint can do work: motors, servos, and a gap of more than a hundredth of a body that it
/// closes.
bool joints_drive(const Model& model, const State& s);

}  // namespace truestep::rigid2d
