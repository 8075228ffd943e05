// Position-based cloth and ropes through the same ports as those of springs: a ball that comes to rest in a
// cloth has received its weight times the time, a free cloth keeps the momentum of a marble, and a body hangs
// on a rope by an attachment.
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using testing_coupled::SceneRun;
using testing_coupled::sums;

TEST(XpbdCoupling, ClothCarriesABall) {
  SceneRun run(R"({"schema_version": "1.0", "name": "s", "time": {"dt": 0.016666666666666666, "substeps": 16},
    "systems": [{"type": "xpbd", "id": "cloth", "mass": 0.002, "stiffness": 1000, "shear_stiffness": 300,
                 "internal_damping": 0.2, "damping": 0.01, "pinned": ["border"], "thickness": 0.02,
                 "cloth_grid": {"origin": [-0.5, 1, -0.5], "nx": 17, "ny": 17}},
                {"type": "rigid3d", "id": "ball",
                 "bodies": [{"type": "sphere", "radius": 0.15, "mass": 1, "position": [0, 1.2, 0]}]}],
    "couplings": [{"type": "contact", "id": "touch", "a": "cloth", "b": "ball", "restitution": 0}]})");
  run.session.step(240);
  // 9.81 N for 4 s; the remaining speed is below 0.1 m/s.
  EXPECT_NEAR(std::abs(run.observe("touch.impulse.y")), 9.81 * 4, 0.1);
  EXPECT_LT(run.observe("touch.penetration"), 1e-5);
}

TEST(XpbdCoupling, FreeClothAndMarbleKeepTheirMomentum) {
  SceneRun run(R"({"schema_version": "1.0", "name": "s", "gravity": [0, 0, 0],
    "time": {"dt": 0.016666666666666666, "substeps": 4},
    "systems": [{"type": "xpbd", "id": "cloth", "mass": 0.002, "stiffness": 1000, "thickness": 0.02,
                 "cloth_grid": {"origin": [-0.5, 1, -0.5], "nx": 17, "ny": 17}},
                {"type": "particles", "id": "marble", "mass": 0.05, "radius": 0.02,
                 "positions": [[0.01, 1.2, 0.02]], "velocities": [[0.3, -3, 0.1]]}],
    "couplings": [{"type": "contact", "id": "touch", "a": "cloth", "b": "marble", "restitution": 0.2}]})");
  const auto before = sums(*run.world, run.session.state());
  run.session.step(60);
  const auto after = sums(*run.world, run.session.state());
  EXPECT_GT(norm(run.observe3("touch.impulse")), 0.01);
  // Rounding of some thousand substeps.
  EXPECT_LT(norm(after.linear - before.linear), 1e-11 * before.scale);
}

TEST(XpbdCoupling, BodyHangsOnARope) {
  SceneRun run(R"({"schema_version": "1.0", "name": "s", "time": {"dt": 0.016666666666666666, "substeps": 32},
    "systems": [{"type": "xpbd", "id": "rope", "rope": {"from": [0, 2, 0], "to": [0, 1, 0], "links": 20},
                 "mass": 0.01, "stiffness": 20000, "pinned": ["first"], "internal_damping": 1},
                {"type": "rigid3d", "id": "weight",
                 "bodies": [{"type": "box", "half_extents": [0.1, 0.1, 0.1], "mass": 2, "position": [0, 0.9, 0]}]}],
    "couplings": [{"type": "attachment", "id": "hook", "a": "rope", "b": "weight",
                   "link": "rigid", "a_points": [20], "b_points": [0],
                   "places": [[0, 1, 0]]}],
    "probes": [{"id": "weight", "system": "weight", "index": 0}]})");
  double mean = 0;
  for (int k = 0; k < 240; ++k) run.session.step(1), mean += run.observe("weight.position.y") / 240;
  // N links under 2 kg and the links below: (2 N + 0.01 sum k) g / k, about which it bounces by as much;
  // fourteen periods, the last of them cut off somewhere, are right to 1 / (2 pi 14), and the impulses at the
  // ends of substeps add to that.
  const double stretch = (2 * 20 + 0.01 * 210) * 9.81 / 20000;
  EXPECT_NEAR(mean, 0.9 - stretch, 0.05 * stretch);
}

}  // namespace
}  // namespace truestep
