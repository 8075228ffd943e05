// Points that hit bodies of the plane: outlines that nothing passes. (Momenta, corners under ropes and
// sleepers that wake are in tests/scenes/couplings.)
#include <cmath>

#include "tests/support/jointed_bodies.h"

namespace truestep {
namespace {

using namespace testing_coupled;

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

}  // namespace
}  // namespace truestep
