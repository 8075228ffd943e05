// Steps of trees of links and of skeletons allocate in the first step only.
#include <gtest/gtest.h>

#include "engine/systems/articulation/articulation_def.h"
#include "engine/systems/skeleton/skeleton.h"
#include "tests/determinism/allocations/allocation_count.h"

namespace truestep {
using namespace articulation;
namespace {

TEST(Allocation, TreesOfLinksAllocateNothingAfterTheFirstStep) {
  ArticulationDef d;
  LinkDef link;
  link.joint = JointType::spherical, link.mass = 1, link.center = {0, -0.5, 0},
  link.inertia = {0.1, 0.01, 0.1};
  link.id = "chain", link.copies = LinkCopiesDef{20, {0, -1, 0}}, link.rotation = {0, 0, 1};
  d.links.push_back(link);
  d.closures.push_back({"chain", "ground", {0, -1, 0}, {16, -10.5, 0}});
  d.springs.push_back({"chain", "ground", {0, -0.5, 0}, {0, -10, 0}, 10, 1, 3});
  for (const char* method : {"rk4", "dop853"}) {
    d.integrator = method;
    test::CountedSteps run(build_articulation(&d, {}), 1.0 / 100);
    run.steps(1);
    EXPECT_EQ(run.steps(19), 0u) << method;
  }
}

TEST(Allocation, ImplicitStepsOfLinksAllocateNothingAfterTheFirst) {
  ArticulationDef d;
  LinkDef link;
  link.joint = JointType::spherical, link.mass = 1, link.center = {0, -0.5, 0},
  link.inertia = {0.1, 0.01, 0.1};
  link.copies = LinkCopiesDef{20, {0, -1, 0}}, link.rotation = {0, 0, 0.1}, link.stiffness = 50;
  link.force = {1, 0, 0};
  d.links.push_back(link);
  for (const char* method : {"implicit_euler", "linear_implicit_euler", "trapezoid", "bdf2", "tr_bdf2",
                             "sdirk4", "rodas5p", "radau5"}) {
    d.integrator = method;
    test::CountedSteps run(build_articulation(&d, {}), 1.0 / 100);
    run.steps(1);
    EXPECT_EQ(run.steps(19), 0u) << method;
  }
}

TEST(Allocation, SkeletonsThatReachAllocateNothingAfterTheFirstStep) {
  using animation::IkMethod;
  for (const IkMethod method : {IkMethod::gradient, IkMethod::gauss_newton, IkMethod::damped_least_squares,
                                IkMethod::ccd, IkMethod::fabrik}) {
    skeleton::SkeletonDef d;
    d.solver = method;
    d.controls.resize(2);
    d.controls[0].name = "a", d.controls[0].value = "sin(3*t)";
    d.controls[1].name = "b", d.controls[1].times = {0, 1}, d.controls[1].values = {0, 1};
    for (int j = 0; j < 8; ++j) {
      skeleton::JointDef joint;
      joint.id = std::to_string(j);
      if (j > 0) joint.parent = std::to_string(j - 1), joint.offset = {0.2, 0, 0};
      joint.end = Vec3{0.2, 0, 0};
      d.joints.push_back(joint);
    }
    d.goals.resize(1);
    d.goals[0].joint = "7", d.goals[0].target = {"0.6 + 0.3*a", "0.5 + b", "0.2"};
    d.skin.emplace();
    d.skin->tubes = {{"0", "7", 0.1, {}, 16, 12}};
    test::CountedSteps run(skeleton::build_skeleton(&d, {}), 1.0 / 60);
    run.steps(1);
    EXPECT_EQ(run.steps(59), 0u) << static_cast<int>(method);
  }
}

}  // namespace
}  // namespace truestep
