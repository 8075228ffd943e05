// The material point method against closed forms: reference cases mpm.* and fem.bar_gravity.
#include <gtest/gtest.h>

#include <numbers>

#include "engine/geometry/solid.h"
#include "engine/math/trig.h"
#include "tests/unit/mpm/mpm_rig.h"

namespace truestep::mpm {
namespace {

using testing_rig::MpmRun;

MpmDef spinning(Transfer transfer, int dimension) {
  MpmDef d;
  d.dimension = dimension, d.precision = Precision::f64, d.transfer = transfer, d.flip = 0;
  d.low = {-1, -1, -1}, d.high = {1, 1, 1}, d.cell = 0.1;
  BodyDef b;
  b.shape = Shape::ball, b.radius = 0.4, b.spin = {0, 0, 3}, b.velocity = {0.1, -0.2, 0};
  if (dimension == 3) b.spin = {1, -2, 3}, b.velocity.z = 0.15;
  d.bodies = {b};
  return d;
}

// Reference case mpm.apic: Jiang et al. 2015 prove that affine transfers conserve both momenta; hence
// rounding of some hundred substeps. PIC, the control, loses angular momentum.
TEST(MpmValidation, AffineTransfersConserveMomentumAndAngularMomentum) {
  for (const int dimension : {2, 3}) {
    for (const Splines splines : {Splines::quadratic, Splines::cubic}) {
      MpmDef d = spinning(Transfer::apic, dimension);
      d.splines = splines;
      MpmRun run(d, 0.01);
      const double l = run.observe("angular_momentum.z"), p = run.observe("momentum.x");
      run.step(10);
      EXPECT_NEAR(run.observe("angular_momentum.z") / l, 1, 1e-12) << dimension;
      EXPECT_NEAR(run.observe("momentum.x") / p, 1, 1e-12) << dimension;
    }
  }
  MpmRun pic(spinning(Transfer::flip, 2), 0.01);
  const double l = pic.observe("angular_momentum.z");
  pic.step(10);
  EXPECT_LT(pic.observe("angular_momentum.z") / l, 0.99);
}

// A bar of Poisson ratio 0 along y, one foot held by the sticky floor.
MpmDef bar(double length, double width, double e, double rho, double cell) {
  MpmDef d;
  d.precision = Precision::f64, d.cell = cell;
  d.low = {-width * 4, 0, 0}, d.high = {width * 4, length * 1.4, 0};
  d.floor = MpmDef::Floor::sticky;
  BodyDef b;
  b.center = {0, length / 2, 0}, b.half_extents = {width / 2, length / 2, 1};
  b.youngs_modulus = e, b.poisson_ratio = 0, b.density = rho;
  d.bodies = {b};
  return d;
}

// Reference case mpm.vibrating_bar: period within 1 %, amplitude after five periods within 5 %.
TEST(MpmValidation, ABarVibratesInItsFirstMode) {
  const double length = 25, v0 = 0.1, period = 10;
  MpmDef d = bar(length, 1, 100, 1, 0.5);
  d.transfer = Transfer::flip, d.flip = 1;
  MpmRun run(d, 0.05);
  const auto v = run.state.f64(columns::velocity);
  for (size_t i = 0; i < v.size() / 3; ++i)
    v[3 * i + 1] = v0 * trig::sin(std::numbers::pi * run.position(i).y / (2 * length));
  const double mass = length, amplitude = v0 * 2 / std::numbers::pi * mass;
  double last = run.observe("momentum.y"), crossing = 0, least = 0;
  EXPECT_NEAR(last / amplitude, 1, 0.001);
  int crossings = 0;
  while (run.steps * run.h < 5 * period) {
    run.step();
    const double now = run.observe("momentum.y"), t = run.steps * run.h;
    if (last * now < 0) crossing = t - run.h * now / (now - last), ++crossings;
    if (t > 4 * period) least = std::min(least, now);
    last = now;
  }
  // The momentum is that of a cosine: zero at a quarter and three quarters of every period.
  ASSERT_EQ(crossings, 10);
  EXPECT_NEAR(crossing / (4.75 * period), 1, 0.01);
  EXPECT_NEAR(-least / amplitude, 1, 0.05);
}

struct Meeting {
  double contact = 0, start = 0, end = 0, momentum = 0, back = 0;
};
/// Two disks in f64, with one or two velocity fields.
Meeting disks(int field_of_second) {
  MpmDef d;
  d.precision = Precision::f64, d.cell = 1.0 / 80, d.transfer = Transfer::flip, d.flip = 1;
  d.walls = Contact::slip;
  BodyDef a;
  a.shape = Shape::ball, a.radius = 0.2, a.center = {0.2, 0.2, 0}, a.velocity = {0.1, 0.1, 0};
  a.youngs_modulus = 1000, a.poisson_ratio = 0.3, a.material = Law::neo_hookean;
  BodyDef b = a;
  b.center = {0.8, 0.8, 0}, b.velocity = {-0.1, -0.1, 0}, b.velocity_field = field_of_second;
  // Half a cell from the walls, whose nodes would hold a disk that touches them.
  d.low = {-0.1, -0.1, 0}, d.high = {1.1, 1.1, 0};
  d.bodies = {a, b}, d.field_friction = 0;
  MpmRun run(d, 0.01);
  Meeting out;
  out.start = run.observe("energy.kinetic");
  while (run.steps * run.h < 3.4) {
    run.step();
    if (out.contact == 0 && run.observe("energy.elastic") > 1e-4 * out.start) out.contact = run.steps * run.h;
  }
  out.momentum = run.observe("momentum.x");
  out.end = run.observe("energy.kinetic") + run.observe("energy.elastic"), out.back = -run.velocity(0).y;
  return out;
}

// Reference case mpm.disks: kinetic energy at the start, time of contact within a cell over the relative
// speed, momentum 0, at most 5 % of the energy lost with FLIP (which holds from 80 cells a metre). With one
// velocity field, the control, quadratic splines let the disks feel each other two cells early.
TEST(MpmValidation, TwoDisksMeetAndPart) {
  const double cell_over_speed = 1.0 / 80 / (0.2 * std::sqrt(2.0));
  for (const int field : {1, 0}) {
    const Meeting m = disks(field);
    // The particles' area is the disk's up to the cells on its border: one in a hundred.
    EXPECT_NEAR(m.start / 2.51327412287183459, 1, 0.02);
    if (field == 1) {
      EXPECT_NEAR(m.contact, 1.5857864376269, cell_over_speed);
    } else {
      EXPECT_LT(m.contact, 1.5857864376269 - cell_over_speed) << "control";
    }
    EXPECT_NEAR(m.momentum, 0, 1e-10);
    EXPECT_GT(m.end / m.start, 0.95);
    EXPECT_LT(m.end / m.start, 1.01);
    EXPECT_GT(m.back, 0) << "the lower disk turns back";
  }
}

// Reference case mpm.gvmms: a manufactured body force rotates a ring through alpha(R, t) and back within a
// period of 1. Relative displacement at t = 0.5 within 2 %. Cubic splines and sixteen particles per cell:
// strains of 6 tear gaps into coarser samplings.
MpmDef vortex(double cell) {
  MpmDef d;
  d.cell = cell, d.particles_per_axis = 4, d.splines = Splines::cubic;
  d.low = {-1.5, -1.5, 0}, d.high = {1.5, 1.5, 0};
  BodyDef b;
  b.shape = Shape::ball, b.radius = 1.25, b.inner_radius = 0.75, b.center = {0, 0, 0};
  b.material = Law::neo_hookean, b.youngs_modulus = 1000, b.poisson_ratio = 0.3, b.density = 1000;
  d.bodies = {b};
  const std::string r = "sqrt(x*x+y*y)", s = "(" + r + "-1)", g = "(0.5*(1-cos(2*pi*t)))",
                    h = "(1-32*" + s + "^2+256*" + s + "^4)", h1 = "(1024*" + s + "^3-64*" + s + ")",
                    h2 = "(3072*" + s + "^2-64)", mu = "(1/2.6)";
  const std::string radial =
      "(" + mu + "*(" + r + "*" + g + "*" + h1 + ")^2/" + r + "-" + r + "*(pi*sin(2*pi*t)*" + h + ")^2)";
  const std::string round =
      "(" + r + "*2*pi^2*cos(2*pi*t)*" + h + "-" + mu + "*" + g + "*(3*" + h1 + "+" + r + "*" + h2 + "))";
  d.force = {"(" + radial + "*x-" + round + "*y)/" + r, "(" + radial + "*y+" + round + "*x)/" + r};
  const std::string a = "(" + g + "*" + h + ")";
  d.exact = {"x*cos" + a + "-y*sin" + a, "x*sin" + a + "+y*cos" + a};
  return d;
}

/// Root mean square error over that of the displacement, at t = 0.5.
double vortex_error(const MpmDef& d) {
  MpmRun run(d, 0.01);
  EXPECT_NEAR(run.observe("error.exact"), 0, 1e-7) << "places in floats";
  run.seconds(0.5);
  const auto places = places_of(d, d.bodies[0]);
  double displacement = 0;
  for (const Vec3& p : places) {
    const double r = norm(p), s = (r - 1) * (r - 1), alpha = 1 - 32 * s + 256 * s * s;
    displacement += 4 * r * r * trig::sin(alpha / 2) * trig::sin(alpha / 2);
  }
  return run.observe("error.exact") / std::sqrt(displacement / static_cast<double>(places.size()));
}

// The case's 2 % are reached beyond the resolutions that a test has time for (docs/mpm.md): here the error
// falls at least with the first power of the cell size, a bound set after a run (0.095 and 0.037 of the
// displacement).
TEST(MpmValidation, ARingIsTurnedByTheGeneralisedVortex) {
  const double coarse = vortex_error(vortex(1.0 / 20)), fine = vortex_error(vortex(1.0 / 40));
  EXPECT_LT(fine, 0.05);
  EXPECT_LT(fine, 0.5 * coarse);
  // Control: without the force the ring stays where it is.
  MpmDef without = vortex(1.0 / 20);
  without.force = {};
  EXPECT_NEAR(vortex_error(without), 1, 1e-4);
}

// Two-way contact: what the jelly loses the ball gains and vice versa, linear and angular, to rounding of
// some hundred substeps.
TEST(MpmValidation, JellyAndABallExchangeMomentumToRounding) {
  const Solid ball = sphere_solid(0.15);
  for (const Contact contact : {Contact::sticky, Contact::slip, Contact::separate}) {
    MpmDef d;
    d.dimension = 3, d.precision = Precision::f64, d.cell = 0.1, d.contact = contact;
    d.low = {-1, -1, -1}, d.high = {1, 1, 1};
    BodyDef b;
    b.center = {-0.35, 0, 0}, b.half_extents = {0.2, 0.2, 0.2}, b.velocity = {2, 0.1, 0};
    d.bodies = {b};
    MpmRun run(d, 0.01);
    std::vector<ImmersedBody> bodies(1);
    bodies[0].solid = &ball, bodies[0].mass = 20, bodies[0].moments = Vec3{1, 1, 1} * (0.4 * 20 * 0.0225);
    bodies[0].place = {0.05, 0.08, 0};
    bodies[0].orientation = {1, 0, 0, 0};
    const auto sums = [&] {
      const ImmersedBody& o = bodies[0];
      const Vec3 l =
          cross(o.place, o.velocity) * o.mass + free_rotation::momentum({o.orientation, o.spin}, o.moments);
      return std::array<double, 3>{run.observe("momentum.x") + o.mass * o.velocity.x,
                                   run.observe("momentum.y") + o.mass * o.velocity.y,
                                   run.observe("angular_momentum.z") + l.z};
    };
    const auto before = sums();
    run.step(15, bodies);
    const auto after = sums();
    // Of 128 kg m/s; rounding of a thousand nodes' sums, several times over.
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(after[k], before[k], 1e-11 * 128) << k;
    EXPECT_GT(bodies[0].velocity.x, 0.5) << "control: the ball is pushed";
  }
}

// A ball resting on jelly: after it has settled, it exerts its weight. The mean over a second of the residual
// oscillation; a fiftieth.
TEST(MpmValidation, AHeavyBallRestsOnWhatItLiesOn) {
  const Solid ball = sphere_solid(0.15);
  MpmDef d;
  d.dimension = 3, d.cell = 0.1, d.transfer = Transfer::flip, d.flip = 0.5;
  BodyDef b;
  b.center = {0.5, 0.2, 0.5}, b.half_extents = {0.5, 0.2, 0.5}, b.youngs_modulus = 1e5;
  d.bodies = {b};
  MpmRun run(d, 1.0 / 60, {0, -9.81, 0});
  std::vector<ImmersedBody> bodies(1);
  bodies[0].solid = &ball, bodies[0].mass = 28, bodies[0].moments = Vec3{1, 1, 1} * (0.4 * 28 * 0.0225);
  bodies[0].place = {0.5, 0.56, 0.5};
  run.step(120, bodies);
  bodies[0].impulse = {};
  run.step(60, bodies);
  EXPECT_NEAR(bodies[0].impulse.y / (28 * 9.81), 1, 0.02);
  EXPECT_GT(bodies[0].place.y, 0.35) << "it has not sunk through";
}

// The bar of fem.bar_gravity under a sudden load: its centre oscillates about the static deflection, rho g
// L^2 / 3 E averaged over the bar. Not that case's 1e-3 at the tip, which needs a step to equilibrium: 6 % is
// the error of twenty cells and of the linear theory's period at a strain of 5 %.
TEST(MpmValidation, ABarUnderItsOwnWeightIsAsShortAsTheClosedForm) {
  const double length = 1, e = 1e5, rho = 1000, g = 9.81;
  MpmDef d = bar(length, 0.2, e, rho, 0.05);
  MpmRun run(d, 0.001, {0, -g, 0});
  const double start = run.observe("centre.y");
  // Period of the first mode: 4 L sqrt(rho / E) = 0.4 s.
  double sum = 0;
  const int steps = 400;
  for (int k = 0; k < steps; ++k) run.step(), sum += run.observe("centre.y");
  // Mean of rho g (L x - x^2 / 2) / E over the bar: rho g L^2 / 3 E.
  const double expected = rho * g * length * length / (3 * e);
  EXPECT_NEAR((start - sum / steps) / expected, 1, 0.06);
}

}  // namespace
}  // namespace truestep::mpm
