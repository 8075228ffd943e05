// The energy of an interface: forces are its gradient, and keep both momenta.
#include "engine/kernels/sph/interface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

/// J, of places in the plane: the kernel's head comment, by a sum over all pairs.
double energy(const std::vector<Vec3>& x, const PlaneInterface& plane, double support) {
  double sum = 0;
  for (const Vec3& a : x) {
    double near = 1;
    Vec3 n;
    for (const Vec3& b : x) {
      const double q = norm(b - a) / support, p = 1 - q * q;
      if (q == 0 || q >= 1) continue;
      near += p * p * p, n += (b - a) * (p * p / support);
    }
    const double c = near / plane.whole;
    sum += std::sqrt(norm2(n) + plane.softness * plane.softness) - plane.softness +
           plane.hold * plane.whole / 6 * (1 - c) * (1 - c);
  }
  return sum;
}

// A square of 6 x 6 particles, shaken, in its first step: without pressure and viscosity velocities are the
// step times the accelerations. Pressure is there only where liquid is too dense, so the square is spread by
// a quarter.
TEST(SphInterface, ForcesAreTheGradientOfTheEnergy) {
  SphDef d;
  d.dimension = 2, d.low = {-1, -1, 0}, d.high = {1, 1, 1}, d.spacing = 0.05, d.precision = Precision::f64;
  d.kernel = Smoothing::wendland_c2, d.support = 3, d.xsph = 0, d.viscosity = 0;
  d.surface_tension = 3, d.surface_tension_model = Tension::interface;
  d.bodies = {{.half_extents = {0.15, 0.15, 1}}};
  constexpr double kStep = 1e-7, kMoved = 1e-6;
  SphRun run(d, kStep);
  RealColumn<double> places(run.state, columns::position);
  std::vector<Vec3> x;
  for (size_t i = 0; i < run.system.setting().rows; ++i) {
    const double k = static_cast<double>(i);
    x.push_back(places.vector(i) * 1.25 + Vec3{0.004 * std::sin(7 * k), 0.004 * std::sin(11 * k + 1), 0});
    places.set_vector(i, x.back());
  }
  run.step();
  const PlaneInterface plane(2, d.spacing, 0.15);
  const double mass = 1000 * 0.0025, per_energy = 3 / plane.energy;
  Vec3 momentum;
  double spin = 0, largest = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const Vec3 force = run.velocity(i) * (mass / kStep);
    const auto slope = [&](const Vec3& along) {
      const Vec3 at = x[i];
      x[i] = at + along * kMoved;
      const double above = energy(x, plane, 0.15);
      x[i] = at - along * kMoved;
      const double below = energy(x, plane, 0.15);
      x[i] = at;
      return per_energy * (above - below) / (2 * kMoved);
    };
    // Central differences over 1e-6 m of lengths of 0.15 m, and places that have moved on for 1e-7 s.
    EXPECT_NEAR(force.x, -slope({1, 0, 0}), 1e-5) << i;
    EXPECT_NEAR(force.y, -slope({0, 1, 0}), 1e-5) << i;
    momentum += force, spin += cross(x[i], force).z, largest = std::max(largest, norm(force));
  }
  EXPECT_LT(norm(momentum), 1e-9);
  EXPECT_LT(std::abs(spin), 1e-6);
  EXPECT_GT(largest, 0.1) << "control: there are forces";
}

}  // namespace
}  // namespace truestep::sph
