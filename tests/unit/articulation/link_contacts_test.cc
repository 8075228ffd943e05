// Points that hit the links of a tree: faces that nothing passes. (Momenta, the laws of a hit, hooks and
// springs that carry are in tests/scenes/couplings.)
#include <cmath>

#include "engine/collision/point_distance.h"
#include "engine/geometry/transform.h"
#include "tests/support/jointed_bodies.h"

namespace truestep {
namespace {

using namespace testing_coupled;

// No ball is closer to any link than its radius, however fast it arrives.
TEST(LinkContacts, NoBallPassesALink) {
  for (const double speed : {5.0, 200.0}) {
    SceneRun run(scene_of(dust({0.4, 2, 0.3}, {0, -speed, 0}, {0.8, 0.8, 0.4}) + "," + kBody,
                          R"({"type": "contact", "id": "c", "a": "dust", "b": "doll", "restitution": 0})"));
    const BodyPort port = *run.world->system(1).ports().bodies;
    for (int k = 0; k < 150; ++k) {
      run.session.step(1);
      const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
      const ConstBodies b(run.session.state().systems[1], port);
      for (size_t row = 0; row < 3; ++row) {
        const Transform at{rotation(b.orientation(row)), b.place(row)};
        for (size_t i = 0; i < p.count; ++i) {
          const auto d = point_distance(*b.form(row).solid, at.inverse_point(p.place(i)), 0.1);
          if (d) {
            ASSERT_GT(d->distance, 0.02 - 1e-4) << speed << " ball " << i << " link " << row << " step " << k;
          }
        }
      }
    }
    EXPECT_GT(run.observe("c.impulse.sum"), 10);
  }
}

}  // namespace
}  // namespace truestep
