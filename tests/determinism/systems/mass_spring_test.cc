// The bits of a cloth do not depend on threads, on scratch memory, or on other uses of the system.
#include "tests/unit/soft/mass_spring_rig.h"

namespace truestep {
using namespace mass_spring;
namespace {

using testing_rig::SpringRun;

class SpringDeterminism : public ::testing::TestWithParam<const char*> {
 protected:
  static MassSpringDef cloth() {
    MassSpringDef d;
    d.integrator = GetParam();
    d.cloth_grid = ClothGridShape{.origin = {0, 1, 0}, .nx = 60, .ny = 60};
    d.bending_stiffness = 20;
    d.pinned = {"corner_00", "corner_10"};
    d.internal_damping = 0.02;
    d.wind = Vec3{1, 0, 3};
    d.colliders.push_back(SphereColliderDef{{}, {0.5, 0.6, 0.5}, 0.3, false});
    return d;
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, SpringDeterminism,
                         ::testing::Values("symplectic_euler", "rk4", "linear_implicit_euler",
                                           "implicit_euler"));

TEST_P(SpringDeterminism, ThreadsChangeNothing) {
  SpringRun one(cloth()), two(cloth(), {0, -9.81, 0}, 2), four(cloth(), {0, -9.81, 0}, 4);
  for (SpringRun* run : {&one, &two, &four}) run->step(0.001, 100);
  EXPECT_EQ(one.state, two.state);
  EXPECT_EQ(one.state, four.state);
}

TEST_P(SpringDeterminism, DroppedWorkspaceChangesNothing) {
  SpringRun kept(cloth()), dropped(cloth());
  for (int i = 0; i < 50; ++i) {
    kept.step(0.001);
    dropped.step(0.001);
    dropped.workspace.clear();
    ASSERT_EQ(kept.state, dropped.state) << "step " << i;
  }
}

TEST_P(SpringDeterminism, RestoredStateContinuesTheSameTrajectory) {
  SpringRun run(cloth());
  run.step(0.001, 30);
  SpringRun other(cloth());
  other.state = State::deserialize(run.state.serialize());
  other.steps = run.steps;
  run.step(0.001, 30);
  other.step(0.001, 30);
  EXPECT_EQ(run.state, other.state);
}

}  // namespace
}  // namespace truestep
