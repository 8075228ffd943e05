// Points that hit bodies of the plane: momentum, outlines and corners that nothing passes, sleepers that
// wake.
#include <cmath>

#include "engine/geometry/transform.h"
#include "engine/kernels/contact/point_hull.h"
#include "tests/support/jointed_bodies.h"

namespace truestep {
namespace {

using namespace testing_coupled;

TEST(FlatBodies, BallsInThePlaneKeepMomentum) {
  for (const char* law : {R"("restitution": 1, "friction": 0)", R"("restitution": 0.3, "friction": 0.6)"}) {
    SceneRun run(
        scene_of(dust({0, 2.5, 0}, {0, -4, 0}, {2, 1.2, 0}) + "," + kFlat,
                 R"({"type": "contact", "id": "c", "a": "dust", "b": "flat", )" + std::string(law) + "}"));
    const auto sums = [&] {
      Momenta m = of_points(run);
      m.linear += Vec3{run.observe("flat.momentum.x"), run.observe("flat.momentum.y"), 0};
      m.angular += Vec3{0, 0, run.observe("flat.angular_momentum.z")};
      return m;
    };
    const Momenta before = sums();
    double worst = 0;
    for (int k = 0; k < 300; ++k) {
      const Momenta then = sums();
      run.session.step(1);
      const Momenta now = sums();
      // Before the balls drive the bodies together, whose own contacts are swept a limited number of times.
      if (k < 100)
        worst = std::max({worst, norm(now.linear - then.linear), std::abs(now.angular.z - then.angular.z)});
    }
    EXPECT_LT(worst, 1e-11 * before.scale) << law;
    EXPECT_GT(run.observe("c.impulse.sum"), 10) << law;
    // What is in the plane stays in it.
    const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
    for (size_t i = 0; i < p.count; ++i) ASSERT_EQ(p.place(i).z, 0);
  }
}

/// m, of a point from the outline of the first body of kFlat, a rounded box.
double gap_to_box(const ConstBodies& b, const Vec3& p) {
  const Vec3 q = rotation(b.orientation(0)).apply_inverse(p - b.place(0));
  const double x = std::abs(q.x) - 0.6, y = std::abs(q.y) - 0.2;
  return std::hypot(std::max(x, 0.0), std::max(y, 0.0)) + std::min(std::max(x, y), 0.0) - 0.05;
}

TEST(FlatBodies, NoBallPassesAnOutline) {
  for (const double speed : {4.0, 300.0}) {
    SceneRun run(scene_of(dust({0, 2.5, 0}, {0, -speed, 0}, {2, 1.2, 0}) + "," + kFlat,
                          R"({"type": "contact", "id": "c", "a": "dust", "b": "flat", "restitution": 0})"));
    const BodyPort port = *run.world->system(1).ports().bodies;
    for (int k = 0; k < 150; ++k) {
      run.session.step(1);
      const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
      const ConstBodies b(run.session.state().systems[1], port);
      for (size_t i = 0; i < p.count; ++i)
        ASSERT_GT(gap_to_box(b, p.place(i)), 0.02 - 1e-4) << speed << " " << i << " step " << k;
    }
    EXPECT_GT(run.observe("c.impulse.sum"), 10);
  }
}

// A rope falls across a triangle whose corner points up between two of its points: lines in the plane have
// sides, and the corner stays on its own.
TEST(FlatBodies, ACornerDoesNotPassARope) {
  SceneRun run(R"({"time": {"dt": 0.002}, "systems": [
      {"type": "mass_spring", "id": "rope", "rope": {"from": [-1.05, 0.8, 0], "to": [1.05, 0.8, 0], "links": 7}, "mass": 0.1,
       "stiffness": 3000, "internal_damping": 0.5, "thickness": 0.04, "integrator": "velocity_verlet"},
      {"type": "rigid2d", "id": "peak", "bodies": [{"motion": "fixed", "shapes": [{"type": "polygon", "points": [[-0.5, -0.5, 0], [0.5, -0.5, 0], [0, 0.5, 0]]}]}]}],
    "couplings": [{"type": "contact", "id": "c", "a": "rope", "b": "peak", "friction": 0.9}]})");
  for (int k = 0; k < 500; ++k) {
    run.session.step(1);
    const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
    double least = 1;
    for (size_t i = 0; i + 1 < p.count; ++i) {
      const std::array<Vec3, 3> ends{p.place(i), p.place(i + 1), {}};
      const Vec3 corner{0, 0.5, 0};
      least = std::min(least, norm(corner - blend(ends, nearest_on_hull(corner, ends, 2), 2)));
    }
    ASSERT_GT(least, 0.02 - 1e-3) << k;
  }
  EXPECT_GT(run.observe("c.impulse.sum"), 0.5);
}

// A chain is a wall on its left side; a sleeping body wakes where a ball hits it.
TEST(FlatBodies, ChainsHoldAndSleepersWake) {
  SceneRun run(R"({"time": {"dt": 0.004}, "systems": [
      {"type": "particles", "id": "ball", "mass": 50, "radius": 0.1, "positions": [[0.1, 6, 0], [3, 1, 0]]},
      {"type": "rigid2d", "id": "flat", "bodies": [{"motion": "fixed", "shapes": [{"type": "chain", "points": [[-5, 0, 0], [0, 0, 0], [5, 0, 0]]}]},
        {"position": [0, 0.5, 0], "shapes": [{"type": "box"}], "density": 100}]}],
    "couplings": [{"type": "contact", "id": "c", "a": "ball", "b": "flat", "restitution": 0}]})");
  bool slept = false;
  for (int k = 0; k < 500; ++k) {
    run.session.step(1);
    const auto asleep = run.observe("flat.awake") == 0;
    slept |= asleep;
    const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
    for (size_t i = 0; i < p.count; ++i) ASSERT_GT(p.place(i).y, 0.09) << k;
  }
  EXPECT_TRUE(slept);
  EXPECT_GT(run.observe("c.impulse.sum"), 50);
}

}  // namespace
}  // namespace truestep
