// Forward kinematics, its derivatives, limits, skins and blend shapes against closed forms.
#include "engine/kernels/animation/blend.h"
#include "engine/kernels/animation/skinning.h"
#include "tests/unit/animation/animation_rig.h"

namespace truestep::animation {
namespace {

using testing_rig::Chain;

TEST(JointTree, APlanarChainIsASumOfCosines) {
  Chain chain(5, 0.7, JointKind::revolute);
  double angle = 0;
  Vec3 want;
  for (size_t j = 0; j < 5; ++j) {
    chain.motion[j].value = 0.3 * static_cast<double>(j + 1);
    angle += chain.motion[j].value;
    want += Vec3{0.7 * std::cos(angle), 0.7 * std::sin(angle), 0};
  }
  // The specified bound for forward kinematics.
  EXPECT_LT(norm(chain.place() - want), 1e-12);
  chain.motion[2].value += 1e-6;
  EXPECT_GT(norm(chain.place() - want), 1e-7);
}

TEST(JointTree, SlidesAndBallsInFramesOfTheirOwn) {
  std::vector<Joint> joints(3);
  joints[0].kind = JointKind::prismatic, joints[0].axis = {0, 1, 0};
  joints[1].parent = 0, joints[1].rest = {{1, 0, 0}, turn_about({0, 0, 1}, 1.5707963267948966)};
  joints[2].parent = 1, joints[2].kind = JointKind::fixed, joints[2].rest.position = {2, 0, 0};
  std::vector<JointMotion> motion(3);
  motion[0].value = 0.5, motion[1].turn = turn_about({0, 1, 0}, 1.5707963267948966);
  std::vector<Pose> poses(3);
  forward_kinematics(joints, motion, {{0, 0, 1}, {}}, poses);
  // Up by 0.5; then x of the ball's frame is the world's y, and its rotation about its own y takes x to -z.
  EXPECT_LT(norm(poses[2].position - Vec3{1, 0.5, -1}), 1e-14);
}

TEST(JointTree, DerivativesAreThoseOfDifferences) {
  std::mt19937 engine(11);
  for (const JointKind kind : {JointKind::revolute, JointKind::prismatic, JointKind::ball}) {
    Chain chain(6, 0.4, kind);
    for (Joint& j : chain.joints) j.axis = normalized(Vec3{0.2, -0.5, 1});
    chain.shake(engine, 1);
    IkGoal g = chain.goal({1, 2, 3});
    g.orientation = free_rotation::turn({0.3, 0.2, -0.4});
    g.weight = 1.3, g.orientation_weight = 0.6;
    chain.place();
    ik_columns(chain.joints, std::span(&g, 1), chain.work);
    ik_jacobian(chain.joints, std::span(&g, 1), chain.work);
    const size_t n = chain.work.joint_of.size();
    const std::vector<double> jacobian = chain.work.jacobian;
    const auto before = chain.motion;
    const double h = 1e-6;
    for (size_t c = 0; c < n; ++c) {
      Vec3 x[2];
      Quat q[2];
      for (int side = 0; side < 2; ++side) {
        chain.motion = before;
        const uint32_t j = chain.work.joint_of[c];
        move_freedom(chain.joints[j], chain.work.freedom_of[c], side ? h : -h, chain.motion[j]);
        x[side] = chain.place(), q[side] = chain.work.poses.back().orientation;
      }
      const Vec3 move = (x[1] - x[0]) * (1.3 / (2 * h));
      const Vec3 turn = free_rotation::rotation_vector(q[1] * conjugate(q[0])) * (1.3 * 0.6 / (2 * h));
      for (size_t k = 0; k < 3; ++k) {
        // Central differences: h^2 = 1e-12 of the third derivative, rounding 1e-10.
        EXPECT_NEAR(jacobian[k * n + c], (&move.x)[k], 2e-9);
        EXPECT_NEAR(jacobian[(3 + k) * n + c], (&turn.x)[k], 2e-9);
      }
    }
  }
}

TEST(JointTree, LimitsHoldSwingAndTwist) {
  Joint j;
  j.axis = {0, 1, 0}, j.cone = 0.5, j.min = -0.2, j.max = 0.3;
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> u(-3, 3);
  for (int k = 0; k < 200; ++k) {
    JointMotion m;
    m.turn = free_rotation::turn({u(engine), u(engine), u(engine)});
    apply_limits(j, m);
    const auto [swing, twist] = swing_twist(m.turn, j.axis);
    EXPECT_LE(norm(free_rotation::rotation_vector(swing)), 0.5 + 1e-12);
    EXPECT_GE(twist, -0.2 - 1e-12);
    EXPECT_LE(twist, 0.3 + 1e-12);
    EXPECT_FALSE(JointMotion(m).turn == Quat{} && apply_limits(j, m)) << "what holds stays";
  }
  JointMotion inside;
  inside.turn = turn_about({1, 0, 0}, 0.4);
  EXPECT_FALSE(apply_limits(j, inside));
}

TEST(Skinning, TwistShrinksMeansOfMatricesAndNotDualQuaternions) {
  // anim.blend: halfway between bones that are twisted relative to each other.
  const double want[][2] = {
      {60, 0.866025403784439}, {90, 0.707106781186548}, {120, 0.5}, {150, 0.258819045102521}};
  for (const auto& [degrees, factor] : want) {
    const Pose rest, turned{{}, turn_about({1, 0, 0}, degrees * 0.017453292519943295)};
    const BoneMatrix bones[] = {bone_matrix(rest, rest), bone_matrix(rest, turned)};
    const DualQuat duals[] = {dual_quaternion(rest, rest), dual_quaternion(rest, turned)};
    SkinWeights w;
    w.bone = {0, 1, 0, 0}, w.weight = {0.5, 0.5, 0, 0};
    const double x[] = {0.3, 1, 0};
    double linear[3], dual[3];
    skin_linear(bones, std::span(&w, 1), x, linear, 0, 1);
    skin_dual_quaternion(duals, std::span(&w, 1), x, dual, 0, 1);
    EXPECT_NEAR(std::hypot(linear[1], linear[2]), factor, 1e-12);
    EXPECT_NEAR(std::hypot(dual[1], dual[2]), 1, 1e-12);
    EXPECT_NEAR(dual[0], 0.3, 1e-15);
  }
}

TEST(Skinning, ARigidMoveMovesAllAlike) {
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto vector = [&] { return Vec3{u(engine), u(engine), u(engine)}; };
  const Pose by{vector(), free_rotation::turn(vector() * 2.0)};
  std::vector<BoneMatrix> bones;
  std::vector<DualQuat> duals;
  for (int k = 0; k < 4; ++k) {
    const Pose rest{vector(), free_rotation::turn(vector())};
    bones.push_back(bone_matrix(rest, by * rest)), duals.push_back(dual_quaternion(rest, by * rest));
  }
  SkinWeights w;
  w.bone = {0, 1, 2, 3}, w.weight = {0.4, 0.3, 0.2, 0.1};
  const Vec3 x = vector(), want = by.position + rotate(by.orientation, x);
  Vec3 linear, dual;
  skin_linear(bones, std::span(&w, 1), &x.x, &linear.x, 0, 1);
  skin_dual_quaternion(duals, std::span(&w, 1), &x.x, &dual.x, 0, 1);
  EXPECT_LT(norm(linear - want), 1e-14);
  EXPECT_LT(norm(dual - want), 1e-14);
}

TEST(Skinning, WeightsAddToOneAndFallWithDistance) {
  const BoneSegment bones[] = {{{0, 0, 0}, {1, 0, 0}}, {{1, 0, 0}, {2, 0, 0}}, {{2, 0, 0}, {3, 0, 0}}};
  for (double x = -0.5; x < 3.5; x += 0.1) {
    const SkinWeights w = weights_by_distance(bones, {x, 0.2, 0}, 4);
    EXPECT_NEAR(w.weight[0] + w.weight[1] + w.weight[2] + w.weight[3], 1, 1e-15);
    EXPECT_GE(w.weight[0], w.weight[1]);
  }
  EXPECT_EQ(weights_by_distance(bones, {0.1, 0.2, 0}, 4).bone[0], 0u);
  EXPECT_EQ(weights_by_distance(bones, {2.9, 0.2, 0}, 4).bone[0], 2u);
}

TEST(BlendShapes, AreLinear) {
  blend_shapes::BlendShapesDef d;
  d.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, d.triangles = {0, 1, 2};
  d.controls.resize(2);
  d.controls[0].name = "a", d.controls[0].value = "0.3";
  d.controls[1].name = "b", d.controls[1].value = "a + 0.2";
  d.targets.resize(3);
  d.targets[0].name = "up", d.targets[0].weight = "a",
  d.targets[0].vertices = {{0, 0, 1}, {1, 0, 2}, {0, 1, 3}};
  d.targets[1].name = "wide", d.targets[1].weight = "b", d.targets[1].offset = {"x", "y"};
  d.targets[2].name = "both", d.targets[2].weight = "a*b", d.targets[2].offset = {"0", "0", "1"};
  testing_rig::AnimationRun<blend_shapes::BlendShapes> run(d);
  // v = b0 + sum w (b - b0): anim.blend.
  std::vector<double> scratch;
  const auto* x = static_cast<const double*>(run.system->field(run.state, 0, 0, scratch).data);
  EXPECT_LT(norm(load3(x, 1) - Vec3{1.5, 0, 0.3 * 2 + 0.15}), 1e-15);
  EXPECT_LT(norm(load3(x, 2) - Vec3{0, 1.5, 0.3 * 3 + 0.15}), 1e-15);
  EXPECT_NEAR(run.observe("weight.both"), 0.15, 1e-15);
  run.system->apply(run.state, {.kind = CommandKind::set_parameter, .value = 1, .name = "a"});
  run.step();
  EXPECT_NEAR(run.observe("weight.wide"), 1.2, 1e-15) << "what follows from a set control follows it";
}

}  // namespace
}  // namespace truestep::animation
