// A skeleton of a ball, a pin, a slider and another ball hands over to links of an articulation with joints
// of the same kinds: what only coordinates of joints and angular momenta show. (Momenta, impacts, the way
// back and that a turning chain differs by chords and tangents are in tests/scenes/animation.)
#include <cmath>

#include "engine/core/ports/rig_port.h"
#include "engine/kernels/animation/rotations.h"
#include "tests/support/coupled.h"
#include "tests/support/scene_file.h"

namespace truestep {
namespace {

using boost::json::array;
using boost::json::object;
using testing_coupled::SceneRun;

constexpr double kMass[] = {2, 1, 0.8, 0.5};

/// The arm of tests/scenes/animation/bones_carry_links.json.
struct Arm {
  object scene = testing::scene_file("animation/bones_carry_links");
  object& joint(size_t k) { return system(0)["joints"].as_array()[k].as_object(); }
  object& link(size_t k) { return system(1)["links"].as_array()[k].as_object(); }
  /// Weightless, without turns, let go at a time.
  void let_go(double at) {
    scene["gravity"] = {0, 0, 0};
    scene["couplings"].as_array()[0].as_object()["at"] = at;
    for (const size_t k : {size_t{0}, size_t{3}}) joint(k)["rotation"] = array{"0", "0", "0"};
    joint(1)["value"] = joint(2)["value"] = "0";
  }
  std::string text() const { return write_json(scene); }

 private:
  object& system(size_t k) { return scene["systems"].as_array()[k].as_object(); }
};

/// kg m^2/s about the origin, of links that move like the bones.
Vec3 angular_momentum_of_bones(const SceneRun& run) {
  const RigPort rig = *rig_of(run.world->system(0));
  const Ports ports = run.world->system(1).ports();
  const ConstBodies bones(run.session.state().systems[0], rig.bones),
      links(run.session.state().systems[1], *ports.bodies);
  Vec3 l;
  for (size_t k = 0; k < 4; ++k) {
    const double i = kMass[k] * 0.01;
    l += cross(bones.place(k), bones.velocity(k)) * kMass[k] +
         free_rotation::momentum({links.orientation(k), bones.spin(k)}, {0.2 * i, i, 1.1 * i});
  }
  return l;
}

TEST(RagdollLinks, AreCarriedWithTheBonesAngularMomentum) {
  SceneRun run(Arm().text());
  double spin = 0;
  for (int k = 0; k < 100; ++k) {
    run.session.step(1);
    const Vec3 l = angular_momentum_of_bones(run);
    // A free root takes the momentum: rounding of sums of some 5 kg m/s and of poses of 2 m.
    ASSERT_LT(norm(run.observe3("doll.angular_momentum") - l), 1e-11) << k;
    spin = std::max(spin, norm(l));
  }
  EXPECT_GT(spin, 3) << "the control: it moves";
}

TEST(RagdollLinks, LimitsOfPinAndSliderHoldWhereItFalls) {
  // Released as pin and slider run towards their limits, at 4 rad/s and 0.8 m/s.
  Arm arm;
  arm.let_go(0.1);
  arm.joint(1)["value"] = "4*t", arm.joint(2)["value"] = "0.8*t";
  SceneRun run(arm.text());
  double pin = 0, slide = 0;
  for (int k = 0; k < 200; ++k) {
    run.session.step(1);
    const auto& q = run.session.state().systems[1].f64(0);  // 3 + 4 of the root, pin, slider
    pin = std::max(pin, q[7]), slide = std::max(slide, q[8]);
  }
  // Springs of 1000 N m/rad and N/m hold no more than the available energy: E = k x^2 / 2 at most.
  const double beyond = std::sqrt(2 * run.observe("doll.energy.total") / 1000) + 1e-3;
  EXPECT_GT(pin, 0.5);
  EXPECT_LT(pin, 0.5 + beyond);
  EXPECT_GT(slide, 0.15);
  EXPECT_LT(slide, 0.15 + beyond);
  EXPECT_LT(beyond, 0.2) << "the control: in a second free joints go 4 rad and 0.8 m";
}

TEST(RagdollLinks, ConeAndTwistOfABallHoldWhereItFalls) {
  // Released while it swings at 4 rad/s and twists at 3: a cone of 0.4 rad about x and 0.3 rad of twist.
  Arm arm;
  arm.let_go(0.05);
  arm.joint(3)["rotation"] = array{"3*t", "0", "4*t"};
  object& ball = arm.link(3);
  ball["axis"] = {1, 0, 0}, ball["cone"] = 0.4, ball["lowest"] = -0.3, ball["highest"] = 0.3;
  SceneRun run(arm.text());
  double swing = 0, twist = 0, first = 0;
  for (int k = 0; k < 400; ++k) {
    run.session.step(1);
    const auto q = run.session.state().systems[1].f64(0);  // of the ball after 7 + 1 + 1
    const auto [s, t] = animation::swing_twist({q[9], q[10], q[11], q[12]}, {1, 0, 0});
    swing = std::max(swing, norm(free_rotation::rotation_vector(s))), twist = std::max(twist, std::abs(t));
    if (k == 12) first = run.observe("doll.energy.total");
    // Springs return what they take: 1e-4 of some 3 J, the integrator's tolerance over two seconds.
    if (k > 12) {
      ASSERT_NEAR(run.observe("doll.energy.total"), first, 1e-3) << k;
    }
  }
  const double beyond = std::sqrt(2 * first / 1000) + 1e-3;
  EXPECT_GT(swing, 0.4);
  EXPECT_LT(swing, 0.4 + beyond);
  EXPECT_GT(twist, 0.3);
  EXPECT_LT(twist, 0.3 + beyond);
  EXPECT_LT(beyond, 0.1) << "the control: in two seconds a free ball turns by several rad";
}

}  // namespace
}  // namespace truestep
