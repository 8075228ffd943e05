// Impacts of rigid bodies in 3-D: restitution, rows of balls, spin and bounce.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

using testing::ball;
using testing::box;
using testing::ground;
using testing::RigidRun;

/// contact.cradle: five equal balls in a row with gaps of a millionth of a metre; the first arrives at 1 m/s.
/// Their velocities afterwards.
std::vector<Vec3> cradle(double restitution, double gap) {
  Rigid3dDef d;
  d.precision = Rigid3dDef::Precision::f64;
  d.restitution = restitution, d.friction = 0, d.restitution_speed = 0, d.sleeping = false;
  for (int k = 0; k < 5; ++k) d.bodies.push_back(ball(0.1, {(0.2 + gap) * k - (k == 0 ? 0.1 : 0), 0, 0}));
  std::get<SphereBodyDef>(d.bodies[0]).velocity = {1, 0, 0};
  RigidRun run(d, 1.0 / 240, 1, {});
  run.seconds(0.2);
  return {run.v(0), run.v(1), run.v(2), run.v(3), run.v(4)};
}

TEST(Rigid3dImpact, ACradlePassesTheBlowOn) {
  const auto elastic = cradle(1, 1e-6);
  EXPECT_NEAR(elastic[4].x, 1, 1e-6);
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(norm(elastic[i]), 0, 1e-6) << i;
  const auto lossy = cradle(0.9, 1e-6);
  EXPECT_NEAR(lossy[4].x, 0.81450625, 1e-6 * 0.8145);
  double momentum = 0;
  for (size_t i = 0; i < 5; ++i) momentum += lossy[i].x;
  EXPECT_NEAR(momentum, 1, 1e-12);
  // The control: without restitution all five move on together.
  EXPECT_LT(cradle(0, 1e-6)[4].x, 0.3);
}

TEST(Rigid3dImpact, ABoxThatFallsFlatBouncesFlat) {
  Rigid3dDef d;
  d.restitution = 0.5, d.precision = Rigid3dDef::Precision::f64;
  d.bodies.push_back(ground());
  d.bodies.push_back(box({0.5, 0.1, 0.3}, {0, 0.6, 0}));
  RigidRun run(d, 1.0 / 240);
  double highest = 0, spin = 0;
  // It lands after sqrt(2 * 0.5 / g) = 0.319 s and is at its peak again after half that time.
  for (int k = 0; k < 150; ++k) {
    run.run(1);
    if (run.t() > 0.33) highest = std::max(highest, run.x(1).y);
    spin = std::max(spin, norm(run.w(1)));
  }
  EXPECT_NEAR(highest - 0.1, 0.25 * 0.5, 0.02 * 0.125);
  EXPECT_LT(spin, 1e-6);  // rad/s; if corners hit one after the other it would be some 3
}

TEST(Rigid3dImpact, ASpinningBallIsThrownSidewaysByItsBounce) {
  // Impulse N = (1 + e) m v, friction at most mu N: enough to stop the slip of a solid ball when
  // (2/7) r w < mu (1 + e) v, then v_x = (2/7) r w; else v_x = mu (1 + e) v.
  const auto thrown = [](double friction) {
    Rigid3dDef d;
    d.restitution = 0.8, d.friction = friction, d.precision = Rigid3dDef::Precision::f64;
    d.bodies.push_back(ground());
    SphereBodyDef b = ball(0.1, {0, 0.3, 0});
    b.velocity = {0, -3, 0}, b.angular_velocity = {0, 0, -50};
    d.bodies.push_back(b);
    RigidRun run(d, 1.0 / 240, 1, {});
    run.seconds(0.2);
    return run.v(1);
  };
  EXPECT_NEAR(thrown(1).x, 2.0 / 7 * 0.1 * 50, 1e-6);
  EXPECT_NEAR(thrown(0.1).x, 0.1 * 1.8 * 3, 1e-6);
  EXPECT_NEAR(thrown(0.1).y, 0.8 * 3, 1e-6);
  EXPECT_EQ(thrown(0).x, 0);
}

}  // namespace
}  // namespace truestep
