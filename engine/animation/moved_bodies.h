// Rows moved by something other than forces: poses, and the velocities that lead from one step's end to the
// next, v = (x1 - x0) / h and w = rotation_vector(q1 q0*) / h, so that whatever they hit sees the actual
// motion. The columns are those of a BodyPort whose forms have no mass: impulses do not move them.
#pragma once
#include <string>

#include "engine/core/ports/ports.h"
#include "engine/geometry/shape.h"
#include "engine/kernels/animation/rotations.h"

namespace truestep::animation {

struct MovedBodies {
  State::Column position = 0, velocity = 0, orientation = 0, angular_velocity = 0, form = 0, id = 0;

  /// Adds the columns; row k has form k.
  static MovedBodies add(State& s, const std::string& prefix, size_t rows);
  /// For columns that `add` created first of all, consecutively.
  static constexpr MovedBodies from(State::Column first) {
    return {first, first + 1, first + 2, first + 3, first + 4, first + 5};
  }
  static constexpr State::Column kCount = 6;

  Pose pose(const State& s, size_t row) const {
    const double* q = s.f64(orientation).data() + 4 * row;
    return {load3(s.f64(position).data(), row), {q[0], q[1], q[2], q[3]}};
  }
  /// Sets the row's pose after a step of h (s); with h = 0 it is only placed and keeps its velocities.
  void place(State& s, size_t row, const Pose& pose, double h) const;
  BodyPort port(std::span<const BodyForm> forms) const {
    return {.position = position,
            .velocity = velocity,
            .orientation = orientation,
            .angular_velocity = angular_velocity,
            .form = form,
            .id = id,
            .forms = forms};
  }
};

/// The same for points: x1 (n x 3) becomes their position.
void place_points(std::span<double> x, std::span<double> v, std::span<const double> x1, double h);

}  // namespace truestep::animation
