// Bodies with separate velocities at the nodes that they share: when they touch, and how they slide.
#include <gtest/gtest.h>

#include "tests/unit/mpm/mpm_rig.h"

namespace truestep::mpm {
namespace {

using testing_rig::MpmRun;

/// m/s, mean over the particles of body k.
Vec3 velocity_of(const MpmRun& run, const MpmDef& d, size_t k) {
  size_t first = 0;
  for (size_t b = 0; b < k; ++b) first += places_of(d, d.bodies[b]).size();
  const size_t many = places_of(d, d.bodies[k]).size();
  Vec3 sum;
  for (size_t i = first; i < first + many; ++i) sum += run.velocity(i);
  return sum / static_cast<double>(many);
}

// A block lies on a slab held by the floor; gravity is turned by 30 degrees. It slides with g (sin - mu cos),
// or sticks if mu > tan = 0.577. Friction is mu times the impulse that supports the block, whatever the
// contact's ripples: 3 %, part of which is the block's own shear.
void check_slope(int dimension, Precision precision, double mu) {
  const double c = std::sqrt(0.75), s = 0.5, g = 9.81;
  MpmDef d;
  d.dimension = dimension, d.precision = precision, d.floor = MpmDef::Floor::sticky;
  d.cell = dimension == 2 ? 1.0 / 32 : 1.0 / 16, d.high = {1.6, 0.8, 0.75};
  d.field_friction = mu;
  BodyDef slab;
  slab.center = {0.8, 0.125, 0.375}, slab.half_extents = {0.7, 0.125, 0.25}, slab.youngs_modulus = 3e5;
  BodyDef block = slab;
  block.center = {0.5, 0.375, 0.375}, block.half_extents = {0.1875, 0.125, 0.125};
  block.velocity_field = 1;
  d.bodies = {slab, block};
  MpmRun run(d, 1.0 / 60, {g * s, -g * c, 0});
  run.step(18);
  const double slides = g * (s - mu * c) * 0.3, v = velocity_of(run, d, 1).x;
  if (slides > 0) {
    EXPECT_NEAR(v, slides, 0.03 * g * s * 0.3) << dimension << mu;
  } else {
    EXPECT_NEAR(v, 0, 0.03 * g * s * 0.3) << dimension << mu;
  }
}
TEST(MpmFieldContact, ABlockOnASlopeSlidesOrSticksAsCoulombSays) {
  for (const double mu : {0.0, 0.3, 0.8}) check_slope(2, Precision::f64, mu);
  check_slope(2, Precision::f32, 0.3);
  check_slope(3, Precision::f32, 0.3), check_slope(3, Precision::f32, 0.8);
}

MpmDef cubes(int dimension, Transfer transfer) {
  MpmDef d;
  d.dimension = dimension, d.precision = Precision::f64, d.transfer = transfer, d.flip = 1;
  d.low = {-1, -1, -1}, d.high = {1, 1, 1}, d.cell = 0.1;
  BodyDef b;
  b.center = {-0.4, 0, 0}, b.half_extents = {0.2, 0.2, 0.2}, b.velocity = {0.5, 0.1, 0};
  BodyDef other = b;
  other.center = {0.3, 0.1, 0.05}, other.velocity = {-0.5, 0, 0}, other.velocity_field = 7;
  other.spin = dimension == 3 ? Vec3{0.3, 0, 0} : Vec3{};
  d.bodies = {b, other};
  return d;
}

// Faces 0.3 m apart that approach at 1 m/s meet at 0.3 s: within a tenth of a cell, a step of 5 ms and the
// strain that counts as contact. A single velocity field, the control, is more than a cell early.
TEST(MpmFieldContact, FacesMeetWhenTheyMeet) {
  for (const int dimension : {2, 3}) {
    for (const bool own : {true, false}) {
      MpmDef d = cubes(dimension, Transfer::flip);
      d.bodies[1].spin = {};
      if (!own) d.bodies[1].velocity_field = 0;
      MpmRun run(d, 0.005);
      const double start = run.observe("energy.kinetic");
      while (run.observe("energy.elastic") < 1e-4 * start && run.steps < 100) run.step();
      const double contact = static_cast<double>(run.steps) * run.h;
      if (own) {
        EXPECT_NEAR(contact, 0.3, 0.1 * d.cell + 2 * run.h) << dimension;
      } else {
        EXPECT_LT(contact, 0.3 - d.cell) << "control";
      }
    }
  }
}

// To rounding over some hundred substeps, through an off-centre impact with friction.
TEST(MpmFieldContact, CubesThatMeetKeepBothMomenta) {
  for (const int dimension : {2, 3}) {
    MpmDef d = cubes(dimension, Transfer::apic);
    MpmRun run(d, 0.01);
    const double p = run.observe("momentum.y"), l = run.observe("angular_momentum.z");
    run.step(60);
    EXPECT_NEAR(run.observe("momentum.x"), 0, 1e-11) << dimension;
    EXPECT_NEAR(run.observe("momentum.y") / p, 1, 1e-12) << dimension;
    EXPECT_NEAR(run.observe("angular_momentum.z") / l, 1, 1e-11) << dimension;
    EXPECT_LT(velocity_of(run, d, 0).x, 0) << "control: it is thrown back";
  }
}

}  // namespace
}  // namespace truestep::mpm
