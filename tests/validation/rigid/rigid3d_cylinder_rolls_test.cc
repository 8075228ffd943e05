// Cylinders that rotate about their axis. Their surface stays in place then: the material points move towards
// the floor and away from it without ever meeting it, so that a cylinder rolls, and spins in place, as
// smoothly as a ball.
#include <gtest/gtest.h>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep::testing {
using namespace rigid3d;
namespace {

enum class Floor { plane, box };
enum class Shape { cylinder, part, prism };

struct Roller {
  double radius = 0.5, half_length = 0.5;
  Shape shape = Shape::cylinder;
  Floor floor = Floor::plane;
  Rigid3dDef::Precision precision = Rigid3dDef::Precision::f32;
};

/// On its side on the floor, its axis along z; body 1.
Rigid3dDef lying(const Roller& r, double speed, double spin) {
  Rigid3dDef d;
  d.precision = r.precision, d.sleeping = false;
  if (r.floor == Floor::plane) {
    d.bodies.push_back(ground());
  } else {
    BoxBodyDef b = box({200, 1, 20}, {0, -1, 0});
    b.motion = BodyDef::Motion::fixed;
    d.bodies.push_back(b);
  }
  const auto put = [&](auto b) {
    b.position = {0, r.radius, 0}, b.axis = {1, 0, 0}, b.angle = 1.5707963267948966;
    b.velocity = {speed, 0, 0}, b.angular_velocity = {0, 0, spin};
    d.bodies.push_back(b);
  };
  if (r.shape == Shape::cylinder) {
    CylinderBodyDef b;
    b.radius = r.radius, b.half_length = r.half_length;
    put(b);
  } else if (r.shape == Shape::part) {
    CompoundBodyDef b;
    CylinderPartDef part;
    part.radius = r.radius, part.half_length = r.half_length;
    b.parts.push_back(part);
    put(b);
  } else {
    HullBodyDef b;
    for (int k = 0; k < 48; ++k) {
      const double a = 2 * 3.14159265358979 * k / 48;
      for (const double y : {-r.half_length, r.half_length}) {
        b.points.push_back({r.radius * std::cos(a), y, r.radius * std::sin(a)});
      }
    }
    put(b);
  }
  return d;
}

/// Largest deviation (m) from its resting height.
double hop(RigidRun& run, double height, double seconds) {
  double most = 0;
  const auto steps = static_cast<int>(seconds / run.h + 0.5);
  for (int k = 0; k < steps; ++k) run.run(1), most = std::max(most, std::abs(run.x(1).y - height));
  return most;
}

TEST(Rigid3dCylinder, RollsAtTenMetresASecondWithoutHopping) {
  for (const auto precision : {Rigid3dDef::Precision::f32, Rigid3dDef::Precision::f64}) {
    for (const Floor floor : {Floor::plane, Floor::box}) {
      for (const Shape shape : {Shape::cylinder, Shape::part}) {
        for (const double radius : {0.1, 0.5}) {
          for (const double half_length : {0.05, 0.5}) {
            const Roller r{radius, half_length, shape, floor, precision};
            RigidRun run(lying(r, 10, -10 / radius));
            // It gives way by g / (2 pi 60 Hz)^2 = 7e-5 m, twice that where it balances on two points.
            EXPECT_LT(hop(run, radius, 3), 3e-4) << radius << " " << half_length;
            EXPECT_NEAR(run.v(1).x, 10, 1e-2) << radius << " " << half_length;
            EXPECT_NEAR(run.w(1).z * radius, -10, 1e-2) << radius << " " << half_length;
          }
        }
      }
    }
  }
}

TEST(Rigid3dCylinder, SpunInPlaceFeelsFrictionOfMuNAndStaysDown) {
  for (const Floor floor : {Floor::plane, Floor::box}) {
    for (const double spin : {30.0, 100.0, 300.0}) {
      RigidRun run(lying({.floor = floor}, 0, spin));
      EXPECT_LT(hop(run, 0.5, 0.5), 3e-4) << spin;
      // It slides all the time: v = mu g t, and its spin decreases by 2 mu g t / r.
      EXPECT_NEAR(run.v(1).x, -0.5 * 9.81 * 0.5, 0.01) << spin;
      EXPECT_NEAR(run.w(1).z, spin - 2 * 0.5 * 9.81 * 0.5 / 0.5, 0.05) << spin;
    }
  }
}

/// The control: a prism of 48 sides is not a cylinder. It loses 1 - cos(7.5 degrees) of two thirds of its
/// motion at every edge and is down to half of it after 3 s.
TEST(Rigid3dCylinder, APrismOfManySidesDoesNotRollLikeOne) {
  RigidRun run(lying({.shape = Shape::prism, .floor = Floor::box}, 3, -6));
  run.seconds(3);
  EXPECT_LT(run.v(1).x, 2.5);
}

TEST(Rigid3dCylinder, StandingItSpinsWithoutLeavingTheFloor) {
  for (const Floor floor : {Floor::plane, Floor::box}) {
    Rigid3dDef d = lying({.floor = floor}, 0, 0);
    BodyDef& b = std::get<CylinderBodyDef>(d.bodies[1]);
    b.angle = 0, b.angular_velocity = {0, 100, 0};
    RigidRun run(d);
    EXPECT_LT(hop(run, 0.5, 1), 3e-4);
    EXPECT_LT(run.w(1).y, 95);
    // 5 m/s at the rim; what friction at uneven corners leaves.
    EXPECT_LT(std::hypot(run.v(1).x, run.v(1).z), 0.15);
  }
}

}  // namespace
}  // namespace truestep::testing
