// A skeleton whose bones carry bodies until they are released: velocities and momenta continue, free fall
// follows, the skeleton coincides with its bodies, and it returns to its own motion.
#include <cmath>

#include "engine/core/ports/rig_port.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

/// An arm of three bones that rotates and translates, with a capsule on each bone.
std::string arm(const std::string& coupling, const std::string& more_bodies = "",
                const std::string& gravity = "[0, -9.81, 0]") {
  return R"scene({"gravity": )scene" + gravity + R"scene(, "time": {"dt": 0.005}, "systems": [
    {"type": "skeleton", "id": "arm", "bone_radius": 0.05, "root_position": ["0.8*t", "2", "0"], "joints": [
      {"id": "a", "type": "ball", "rotation": ["0", "0", "3*t"]},
      {"id": "b", "parent": "a", "offset": [0.5, 0, 0], "type": "ball", "rotation": ["0.5*sin(4*t)", "0", "2*t"]},
      {"id": "c", "parent": "b", "offset": [0.4, 0, 0], "type": "ball", "rotation": ["0", "sin(3*t)", "0"], "end": [0.3, 0, 0]}]},
    {"type": "rigid3d", "id": "doll", "precision": "f64", "bodies": [
      {"type": "capsule", "radius": 0.05, "half_length": 0.25, "position": [0.25, 2, 0], "axis": [0, 0, 1], "angle": -1.5707963267948966, "mass": 2},
      {"type": "capsule", "radius": 0.05, "half_length": 0.2, "position": [0.7, 2, 0], "axis": [0, 0, 1], "angle": -1.5707963267948966, "mass": 1},
      {"type": "capsule", "radius": 0.05, "half_length": 0.15, "position": [1.05, 2, 0], "axis": [0, 0, 1], "angle": -1.5707963267948966, "mass": 0.5})scene" +
         more_bodies + R"scene(], "joints": [
      {"type": "spherical", "a": 0, "b": 1, "anchor": [0.5, 2, 0]},
      {"type": "spherical", "a": 1, "b": 2, "anchor": [0.9, 2, 0]}]}],
    "couplings": [{"type": "ragdoll", "id": "r", "a": "arm", "b": "doll", "bodies": [0, 1, 2], )scene" +
         coupling + "}]}";
}

struct Motion {
  double mass = 0;
  Vec3 place, momentum, spin;  // m kg, kg m/s, kg m^2/s about the origin
};
Motion motion_of(const testing_coupled::SceneRun& run, size_t count) {
  const Ports ports = run.world->system(1).ports();
  const ConstBodies b(run.session.state().systems[1], *ports.bodies);
  Motion out;
  for (size_t k = 0; k < count; ++k) {
    const BodyForm& f = b.form(k);
    out.mass += f.mass, out.place += b.place(k) * f.mass, out.momentum += b.velocity(k) * f.mass;
    out.spin += cross(b.place(k), b.velocity(k)) * f.mass +
                free_rotation::momentum({b.orientation(k), b.spin(k)}, f.moments);
  }
  return out;
}
/// Of the bones, weighed as their bodies, whose centres are theirs.
Vec3 momentum_of_bones(const testing_coupled::SceneRun& run) {
  const auto rig = rig_of(run.world->system(0));
  const ConstBodies b(run.session.state().systems[0], rig->bones);
  return b.velocity(0) * 2 + b.velocity(1) * 1 + b.velocity(2) * 0.5;
}
double farthest_bone(const testing_coupled::SceneRun& run) {
  const auto rig = rig_of(run.world->system(0));
  const Ports d = run.world->system(1).ports();
  const ConstBodies bones(run.session.state().systems[0], rig->bones),
      bodies(run.session.state().systems[1], *d.bodies);
  double most = 0;
  for (size_t k = 0; k < 3; ++k) most = std::max(most, norm(bones.place(k) - bodies.place(k)));
  return most;
}

TEST(Ragdoll, BodiesAreCarriedUntilTheyAreLetGo) {
  testing_coupled::SceneRun run(arm(R"("at": 0.3)"));
  for (int k = 0; k < 60; ++k) {
    run.session.step(1);
    // Placed where the bones are: rounding.
    ASSERT_LT(farthest_bone(run), 1e-12) << k;
    ASSERT_LT(norm(motion_of(run, 3).momentum - momentum_of_bones(run)), 1e-12) << k;
  }
  EXPECT_EQ(run.observe("r.lead"), 0);
}

TEST(Ragdoll, MomentumGoesOnAtTheHandOver) {
  testing_coupled::SceneRun run(arm(R"("at": 0.3)"));
  run.session.step(60);
  const Motion before = motion_of(run, 3);
  const Vec3 bones = momentum_of_bones(run);
  run.session.step(1);
  EXPECT_EQ(run.observe("r.lead"), 1);
  EXPECT_NEAR(run.observe("r.time"), 0.3, 1e-12);
  const Motion after = motion_of(run, 3);
  const Vec3 g{0, -9.81, 0};
  // A step of free fall and forces between the bodies, which conserve the totals: what is left is rounding of
  // impulses in both directions.
  const double scale = norm(before.momentum);
  EXPECT_LT(norm(after.momentum - before.momentum - g * (before.mass * 0.005)), 1e-12 * scale);
  EXPECT_LT(norm(before.momentum - bones), 1e-12 * scale);
  EXPECT_GT(scale, 3) << "the control: it moves";
  EXPECT_GT(norm(before.spin), 1);
}

TEST(Ragdoll, ItsCentreFallsOnAParabola) {
  testing_coupled::SceneRun run(arm(R"("at": 0.3)"));
  run.session.step(60);
  const Motion start = motion_of(run, 3);
  const Vec3 spin_about_centre = start.spin - cross(start.place, start.momentum) / start.mass;
  run.session.step(80);
  const Motion end = motion_of(run, 3);
  const double t = 80 * 0.005;
  const Vec3 want =
      start.place / start.mass + start.momentum / start.mass * t + Vec3{0, -0.5 * 9.81 * t * t, 0};
  // Five substeps of 1 ms: the centre of mass of a symplectic method lags by g t h / 2 = 2 mm at most.
  EXPECT_LT(norm(end.place / end.mass - want), 0.5 * 9.81 * t * 0.001 * 1.05);
  const Vec3 after = end.spin - cross(end.place, end.momentum) / end.mass;
  // Joints act through anchors of both bodies, which are micrometres apart: 1e-3 of the spin.
  EXPECT_LT(norm(after - spin_about_centre), 1e-3 * norm(spin_about_centre));
  // The skeleton coincides with its bodies, to the gap of the joints.
  EXPECT_LT(farthest_bone(run), 1e-3);
  EXPECT_LT(run.observe("r.apart"), 1e-3);
  // The control: its own motion would be elsewhere.
  testing_coupled::SceneRun free(arm(R"("at": 30)"));
  free.session.step(140);
  EXPECT_GT(norm(motion_of(free, 3).place / 3.5 - end.place / 3.5), 0.1);
}

TEST(Ragdoll, AnImpactLetsItGoWithItsMomentum) {
  // A ball arrives from above in weightlessness; before it hits, the arm's momentum is that of its motion,
  // and the step in which it hits conserves the total of both.
  const std::string ball =
      R"(, {"type": "sphere", "radius": 0.1, "mass": 3, "position": [0.35, 2.95, 0], "velocity": [0.8, -6, 0], "restitution": 0.5})";
  testing_coupled::SceneRun run(arm(R"("impact": 1, "impact_bodies": [0, 1, 2])", ball, "[0, 0, 0]"));
  Vec3 before;
  int steps = 0;
  while (run.observe("r.lead") == 0 && steps < 200) {
    before = motion_of(run, 4).momentum;
    const Vec3 own = motion_of(run, 3).momentum;
    run.session.step(1), ++steps;
    if (run.observe("r.lead") == 0) {
      // While it is carried, its motion is prescribed, whatever leans on it.
      ASSERT_LT(norm(motion_of(run, 3).momentum - momentum_of_bones(run)), 1e-12);
    } else {
      EXPECT_GT(norm(motion_of(run, 3).momentum - own), 3) << "the ball gave it momentum";
    }
  }
  ASSERT_LT(steps, 200);
  EXPECT_GT(run.observe("r.impact"), 1);
  EXPECT_LT(norm(motion_of(run, 4).momentum - before), 1e-12 * norm(before) + 1e-12);
  // And from then on.
  const Vec3 after = motion_of(run, 4).momentum;
  run.session.step(20);
  EXPECT_LT(norm(motion_of(run, 4).momentum - after), 1e-11 * norm(after));
}

TEST(Ragdoll, ItGoesBackToItsOwnMotionWhereItLies) {
  testing_coupled::SceneRun run(
      arm(R"("at": 0.1, "back_after": 0.2, "blend": 0.3, "match_from": 0, "match_to": 2)"));
  run.session.step(60);
  EXPECT_EQ(run.observe("r.lead"), 2);
  const auto places = [&] {
    std::vector<Vec3> out;
    for (const char* j : {"a", "b", "c"}) out.push_back(run.observe3(std::string("arm.joint.") + j));
    return out;
  };
  // Nothing jumps: no joint is faster than the arm or its fall, 10 m/s.
  std::vector<Vec3> last = places();
  for (int k = 0; k < 100; ++k) {
    run.session.step(1);
    const std::vector<Vec3> now = places();
    for (size_t j = 0; j < now.size(); ++j) ASSERT_LT(norm(now[j] - last[j]), 10 * 0.005) << k;
    last = now;
  }
  // Back in its motion: at the height of its own root again, and as rigid as its motion is.
  EXPECT_NEAR(run.observe("arm.joint.a.y"), 2, 1e-9);
  EXPECT_LT(farthest_bone(run), 1e-12) << "and it carries its bodies again";
}

}  // namespace
}  // namespace truestep
