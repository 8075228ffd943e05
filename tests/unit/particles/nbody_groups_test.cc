// Groups of bodies at their start: an orbit has its elements, a ring its speed. (What a scene of bodies must
// not contain, commands and collisions are in tests/scenes/refused/bodies_that_attract.json and
// tests/scenes/orbits.)
#include <cmath>

#include "tests/support/runs/nbody_run.h"

namespace truestep::nbody {
namespace {

using testing_rig::model_units;
using testing_rig::NbodyRun;

TEST(NbodyGroups, AnOrbitHasItsElementsAndARingItsSpeed) {
  NbodyDef d = model_units();
  d.positions = {{1, 2, 3}}, d.velocities = {{0.1, 0, 0}}, d.mass = 2;
  d.groups = {OrbitDef{.mass = 1,
                       .semi_major_axis = 4,
                       .eccentricity = 0.6,
                       .inclination = 0.5,
                       .ascending_node = 1,
                       .periapsis = 2,
                       .mean_anomaly = 0.7},
              RingDef{.count = 10, .inner_radius = 5, .outer_radius = 5, .axis = {0, 3, 0}}};
  NbodyRun run(d, 0.01);
  const Vec3 r = run.x(1) - run.x(0), v = run.v(1) - run.v(0), h = cross(r, v);
  EXPECT_NEAR(0.5 * norm2(v) - 3 / norm(r), -3 / 8.0, 1e-14) << "energy -mu/2a";
  EXPECT_NEAR(norm2(h), 3 * 4 * (1 - 0.36), 1e-13);
  EXPECT_NEAR(h.z / norm(h), std::cos(0.5), 1e-14);
  EXPECT_NEAR(std::atan2(h.x, -h.y), 1, 1e-14) << "the node's longitude";
  const Vec3 e = cross(v, h) / 3 - r / norm(r);
  EXPECT_NEAR(norm(e), 0.6, 1e-14);
  EXPECT_NEAR(e.z / norm(e), std::sin(2.0) * std::sin(0.5), 1e-13);
  for (size_t i = 2; i < 12; ++i) {
    const Vec3 at = run.x(i) - run.x(0), u = run.v(i) - run.v(0);
    EXPECT_NEAR(norm(at), 5, 1e-13);
    EXPECT_NEAR(norm2(u), 2 / 5.0, 1e-14);
    EXPECT_NEAR(dot(cross(at, u), Vec3{0, 1, 0}), 5 * norm(u), 1e-13);
  }
}

}  // namespace
}  // namespace truestep::nbody
