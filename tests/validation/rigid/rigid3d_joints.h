// Bodies and joints for the tests of rigid3d's joints.
#pragma once
#include <cmath>
#include <numbers>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep::testing {

inline constexpr double kG = 9.81;
inline constexpr Vec3 kNoGravity{};

/// A rod of 1 m and 10 kg with one end at the origin, level along x.
inline rigid3d::BoxBodyDef rod() {
  rigid3d::BoxBodyDef b = box({0.5, 0.05, 0.05}, {0.5, 0, 0});
  b.mass = 10;
  return b;
}
/// Its moment about an axis across it through the end.
inline constexpr double kRodMoment = 10 * (1.0 / 3 + 0.01 / 12);

/// Hangs row 0 from the world at the origin, by an axis z where there is one.
template <class J>
J hung() {
  J j;
  j.id = "j", j.a = -1, j.b = 0, j.anchor = Vec3{};
  if constexpr (requires { j.axis; }) j.axis = {0, 0, 1};
  return j;
}
template <class J>
rigid3d::Rigid3dDef pendulum(J j) {
  rigid3d::Rigid3dDef d;
  d.bodies.push_back(rod());
  d.joints.push_back(j);
  return d;
}
/// A ball of 1 kg at x.
inline rigid3d::SphereBodyDef bob(Vec3 x) {
  rigid3d::SphereBodyDef b = ball(0.1, x);
  b.mass = 1;
  return b;
}

/// Largest of |f(run)| over that many steps.
template <class F>
double worst(RigidRun& run, uint64_t steps, F f) {
  double most = 0;
  for (uint64_t k = 0; k < steps; ++k) run.run(1), most = std::max(most, std::abs(f(run)));
  return most;
}

}  // namespace truestep::testing
