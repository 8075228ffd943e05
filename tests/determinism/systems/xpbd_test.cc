// The bits of a cloth solved colour by colour do not depend on threads, on scratch memory, or on a restore in
// between.
#include "tests/unit/soft/xpbd_rig.h"

namespace truestep {
using namespace xpbd;
namespace {

using testing_rig::XpbdRun;

class XpbdDeterminism : public ::testing::TestWithParam<Precision> {
 protected:
  static XpbdDef cloth() {
    XpbdDef d;
    // Colours with several tasks: lines of 200 links in more than four batches.
    d.cloth_grid = ClothGridShape{.origin = {0, 1, 0}, .nx = 201, .ny = 150};
    d.density = 0.2;
    d.pinned = {"corner_00", "corner_10"};
    d.internal_damping = 0.01;
    d.wind = Vec3{3, 0, 1}, d.gust = 0.5;
    d.flexural_rigidity = 1e-5;
    d.precision = GetParam();
    d.colliders.push_back(SphereColliderDef{{}, {0.5, 0.6, 0.5}, 0.3, false});
    return d;
  }
  /// Cloth that falls on a small ball and on itself.
  static XpbdDef folding() {
    XpbdDef d;
    d.cloth_grid = ClothGridShape{.origin = {-0.5, 0.4, -0.5}, .nx = 21, .ny = 21};
    d.density = 0.2, d.shear_stiffness = 500;
    d.self_collision = true;
    d.velocity = {0, -6, 0};
    d.precision = GetParam();
    d.colliders.push_back(SphereColliderDef{{}, {0, 0.3, 0}, 0.05, false});
    return d;
  }
  static XpbdDef block() {
    XpbdDef d;
    d.block = SoftBlockShape{.origin = {0, 0.01, 0}, .cells_x = 9, .cells_y = 9, .cells_z = 9};
    d.density = 1000;
    d.precision = GetParam();
    d.iterations = 2;
    d.colliders.push_back(PlaneColliderDef{});
    return d;
  }
};

INSTANTIATE_TEST_SUITE_P(Precisions, XpbdDeterminism, ::testing::Values(Precision::f64, Precision::f32));

TEST_P(XpbdDeterminism, ThreadsChangeNothing) {
  for (const XpbdDef& d : {cloth(), block()}) {
    XpbdRun one(d), two(d, 1.0 / 60, {0, -9.81, 0}, 2), four(d, 1.0 / 60, {0, -9.81, 0}, 4);
    for (XpbdRun* run : {&one, &two, &four}) run->step(2);
    EXPECT_EQ(one.state, two.state);
    EXPECT_EQ(one.state, four.state);
  }
}

TEST_P(XpbdDeterminism, WhatMeetsItselfIsTheSameWithThreadsAndRestores) {
  XpbdRun one(folding()), two(folding(), 1.0 / 60, {0, -9.81, 0}, 2), dropped(folding()), open([] {
    XpbdDef d = folding();
    d.self_collision = false;
    return d;
  }());
  for (int i = 0; i < 14; ++i) {
    for (XpbdRun* run : {&one, &two, &dropped, &open}) run->step();
    dropped.workspace.clear();
    dropped.state = State::deserialize(dropped.state.serialize());
    ASSERT_EQ(one.state, two.state) << "step " << i;
    ASSERT_EQ(one.state, dropped.state) << "step " << i;
  }
  // The cloth has touched itself.
  EXPECT_NE(one.state, open.state);
}

TEST_P(XpbdDeterminism, DroppedWorkspaceAndRestoreChangeNothing) {
  XpbdRun kept(cloth()), dropped(cloth());
  for (int i = 0; i < 3; ++i) {
    kept.step();
    dropped.step();
    dropped.workspace.clear();
    dropped.state = State::deserialize(dropped.state.serialize());
    ASSERT_EQ(kept.state, dropped.state) << "step " << i;
  }
}

TEST_P(XpbdDeterminism, AChangedParameterIsSeenAtOnce) {
  // The constants are packed and cached: after a command they must equal those of a run that started with
  // them.
  XpbdDef soft = cloth(), stiff = cloth();
  soft.stiffness = 500;
  XpbdRun changed(soft), fresh(stiff);
  changed.step();
  changed.system->apply(changed.state,
                        {.kind = CommandKind::set_parameter, .value = stiff.stiffness, .name = "stiffness"});
  fresh.state = changed.state;
  fresh.steps = changed.steps;
  changed.step();
  fresh.step();
  EXPECT_EQ(changed.state, fresh.state);
}

}  // namespace
}  // namespace truestep
