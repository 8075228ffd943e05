// The particles of a body at the start: as many as fit without compressing the liquid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/fluids/sph_rig.h"

namespace truestep::sph {
namespace {

using testing_rig::SphRun;

/// A body `wide` spacings wide, in the plane or in space, far from walls.
SphDef body_of(int dimension, Shape shape, const Vec3& wide) {
  SphDef d;
  d.dimension = dimension, d.spacing = 0.04, d.precision = Precision::f64;
  d.bodies = {{.shape = shape,
               .center = {0.5, 0.5, 0.5},
               .half_extents = wide * (0.5 * d.spacing),
               .radius = 0.5 * wide.x * d.spacing}};
  return d;
}
/// 1, mean excess of density at the start, over all particles.
double compression(const SphDef& d) {
  SphRun run(d, 1e-9);
  run.step();
  return run.observe("compression.mean");
}

// A body 7.5 spacings wide started with 8 of them, a fifth too dense in space. What remains is the sum of a
// lattice that is wider along one axis than along another: below 1 %, where a session warns.
TEST(SphStart, NeverTakesMoreThanFits) {
  for (const int dimension : {2, 3}) {
    for (int k = 0; k <= 20; ++k) {
      const double w = 7 + 0.05 * k;
      for (const Vec3 wide : {Vec3{w, w, w}, Vec3{w, 9, 8}, Vec3{6, w, 7.6}}) {
        const SphDef d = body_of(dimension, Shape::box, wide);
        const double fits = dimension == 2 ? wide.x * wide.y : wide.x * wide.y * wide.z;
        const double n = static_cast<double>(places_of(d, d.bodies[0]).size());
        EXPECT_LE(n, fits * (1 + 1e-9)) << dimension << ' ' << w;
        // One fewer along an axis, at the least.
        EXPECT_GT(n, 0.8 * fits) << dimension << ' ' << w;
      }
    }
    for (const double w : {7.2, 7.5, 7.8}) {
      EXPECT_LT(compression(body_of(dimension, Shape::box, {w, w, w})), 0.01) << dimension << ' ' << w;
      EXPECT_LT(compression(body_of(dimension, Shape::ball, {w, w, w})), 0.01) << dimension << ' ' << w;
    }
  }
  SphDef twice = body_of(3, Shape::box, {7.5, 7.5, 7.5});
  twice.bodies.push_back(twice.bodies[0]), twice.bodies[1].center.x += 0.02;
  EXPECT_GT(compression(twice), 0.1) << "control: two bodies in one place";
}

TEST(SphStart, WholeNumbersOfSpacingsAreFilled) {
  for (const double w : {5.0, 8.0, 5.00000000001}) {
    EXPECT_EQ(
        places_of(body_of(3, Shape::box, {w, w, w}), body_of(3, Shape::box, {w, w, w}).bodies[0]).size(),
        static_cast<size_t>(std::lround(w * w * w)));
  }
  // Rounding of a width is not a compressed start.
  const SphDef d = body_of(3, Shape::box, {7.9999999999, 8, 8});
  EXPECT_EQ(places_of(d, d.bodies[0]).size(), 512u);
}

// As a body's density, or as the system's: the same bits, and a medium that takes bodies.
TEST(SphStart, OneDensityIsOneLiquid) {
  SphDef own = body_of(3, Shape::box, {6, 6, 6});
  own.bodies.push_back(own.bodies[0]), own.bodies[1].center.y = 0.8;
  SphDef system = own;
  own.bodies[0].density = own.bodies[1].density = 700, system.density = 700;
  SphRun a(own, 1.0 / 60, {0, -9.81, 0}), b(system, 1.0 / 60, {0, -9.81, 0});
  a.step(2), b.step(2);
  EXPECT_EQ(a.state.hash(), b.state.hash());
  EXPECT_EQ(a.observe("mass"), b.observe("mass"));
  EXPECT_TRUE(a.system.ports().medium.has_value());
  own.bodies[1].density = 701;
  EXPECT_FALSE(SphRun(own).system.ports().medium.has_value()) << "control: two densities";
}

}  // namespace
}  // namespace truestep::sph
