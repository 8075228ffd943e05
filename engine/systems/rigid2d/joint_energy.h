// What the joints of a state hold: energy of their springs, and whether they can bring any.
#pragma once
#include "engine/systems/rigid2d/columns.h"

namespace truestep::rigid2d {

/// J in the springs of unbroken joints, sum of k s^2 / 2, with k as it is at t = 0 where a frequency is
/// given.
double spring_energy(const Model& model, const State& s);

/// Largest distance (m) of two points that an unbroken joint keeps together.
double widest_gap(const Model& model, const State& s);

/// True where a joint can do work of its own: motors, servos, and gaps of more than a hundredth of a body
/// that it closes.
bool joints_drive(const Model& model, const State& s);

}  // namespace truestep::rigid2d
