// A liquid of particles with a state, to be stepped by tests.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "engine/base/random.h"
#include "engine/core/ports/medium.h"
#include "engine/systems/sph/sph.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

struct SphRun : SystemRun<sph::Sph> {
  explicit SphRun(const sph::SphDef& def, double dt = 1.0 / 60, Vec3 gravity = {}, int threads = 1)
      : SystemRun([&] { return sph::Sph(def, BuildContext{.id = "s", .gravity = gravity, .dt = dt}); }, dt,
                  threads) {}

  Vec3 position(size_t i) const { return RealColumn<const double>(state, sph::columns::position).vector(i); }
  /// Moves every particle by up to `size` (m) along each axis: another start of the same flow.
  void shake(double size, uint64_t seed) {
    RealColumn<double> x(state, sph::columns::position);
    for (size_t i = 0; i < state.rows(sph::columns::position); ++i) {
      const auto u = uniform4(seed, 0, i);
      const double across = system.setting().def.dimension == 3 ? 2 * u[2] - 1 : 0;
      x.set_vector(i, x.vector(i) + Vec3{2 * u[0] - 1, 2 * u[1] - 1, across} * size);
    }
  }
  /// Pa, the field that is read.
  std::vector<double> pressures() const {
    constexpr size_t kPressure = 3;
    std::vector<double> out;
    system.field(state, 0, kPressure, out);
    return out;
  }
  Vec3 velocity(size_t i) const { return RealColumn<const double>(state, sph::columns::velocity).vector(i); }
};

/// The channel of Morris, Fox & Zhu 1997 (cases sph.couette and sph.poiseuille), at 40 particles across.
inline sph::SphDef channel(sph::Method solver) {
  sph::SphDef d;
  d.dimension = 2, d.low = {0, 0, 0}, d.high = {5e-4, 1e-3, 1}, d.spacing = 2.5e-5;
  d.precision = sph::Precision::f64, d.solver = solver;
  d.xsph = 0, d.viscosity = 1e-6, d.walls = sph::Walls::no_slip, d.periodic = sph::Periodic::x;
  d.bodies = {{.center = {2.5e-4, 5e-4, 0}, .half_extents = {2.5e-4, 5e-4, 1}}};
  return d;
}
/// m/s, in its middle.
inline double middle_speed(const SphRun& run) {
  double sum = 0;
  int count = 0;
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    if (std::abs(run.position(i).y - 5e-4) < 1.3e-5) sum += run.velocity(i).x, ++count;
  }
  return sum / count;
}

}  // namespace truestep::testing_rig
