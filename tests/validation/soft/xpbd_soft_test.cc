// Soft bodies of the system xpbd: shape matching against springs of one frequency, and elastic blocks against
// the equilibrium of finite elements on the same mesh.
#include "engine/base/errors.h"
#include "tests/unit/fem/fem_rig.h"
#include "tests/unit/soft/xpbd_rig.h"

namespace truestep {
using namespace xpbd;
namespace {

using testing_rig::FemRun;
using testing_rig::XpbdRun;

XpbdDef matched(std::optional<double> frequency, double linear = 0) {
  XpbdDef d;
  d.block = SoftBlockShape{
      .origin = {-0.5, -0.25, -0.3}, .size = {1, 0.5, 0.6}, .cells_x = 4, .cells_y = 2, .cells_z = 3};
  d.density = 500;
  d.matching = MatchDef{.frequency = frequency, .linear = linear};
  return d;
}
/// Turns about `spin` and moves along x.
void throw_body(XpbdRun& run, const Vec3& spin) {
  const auto v = run.state.f64(XpbdColumns::velocity);
  for (size_t i = 0; i < v.size() / 3; ++i) store3(v.data(), i, Vec3{2, 0, 0} + cross(spin, run.position(i)));
}

TEST(XpbdMatching, AStretchedBodySwingsWithItsFrequency) {
  XpbdRun run(matched(2), 1.0 / 600, {});
  const auto x = run.state.f64(XpbdColumns::position);
  for (size_t k = 0; k < x.size(); k += 3) x[k] *= 1.1;
  const size_t last = 4;
  double before = run.position(last).x, crossed = 0;
  while (crossed == 0 && run.steps < 600) {
    run.step();
    const double now = run.position(last).x;
    if (now < 0.5) crossed = run.h * (static_cast<double>(run.steps) - (0.5 - now) / (before - now));
    before = now;
  }
  // A quarter of half a second, delayed by the lag of implicit Euler: about a step.
  EXPECT_NEAR(crossed, 0.125, 2 * run.h);
}

TEST(XpbdMatching, KeepsMomenta) {
  for (const double linear : {0.0, 0.7}) {
    XpbdRun run(matched(5, linear), 1.0 / 60, {});
    throw_body(run, {1, 3, -2});
    // It vibrates in addition to its rotation.
    run.state.f64(XpbdColumns::velocity)[3 * 7] += 5;
    const auto p = [&](const char* name) { return run.observe(name); };
    const double px = p("momentum.x");
    const Vec3 l{p("angular_momentum.x"), p("angular_momentum.y"), p("angular_momentum.z")};
    run.seconds(1);
    EXPECT_NEAR(p("momentum.x"), px, 1e-12 * px);
    const Vec3 now{p("angular_momentum.x"), p("angular_momentum.y"), p("angular_momentum.z")};
    // Goals exert no moment on the positions that they move; velocities from positions conserve it to first
    // order: 600 substeps that rotate by 0.006 each, squared, 2 %.
    EXPECT_LT(norm(now - l), 0.03 * norm(l));
  }
}

TEST(XpbdMatching, WithoutAFrequencyABodyIsRigid) {
  XpbdRun run(matched({}), 1.0 / 60, {});
  throw_body(run, {0, 3, 0});
  run.seconds(1);
  // In a substep, points leave the arc of 0.005 rad by its square and are projected back onto it, to
  // rounding.
  EXPECT_LT(run.observe("strain.max"), 1e-12);
  EXPECT_NEAR(run.observe("volume"), 0.3, 1e-12);
  // Rotated about y by 3 rad, less the damping of the method: the square of a substep's rotation is lost,
  // which in 600 of them is 1.5 % of the speed in the end and half of that on average.
  const Vec3 along = run.position(4) - run.position(0);
  EXPECT_NEAR(std::atan2(-along.z, along.x), 3 * (1 - 0.0075), 2e-3);
  // Control: one drawn to its goals at 1 Hz is not.
  XpbdRun soft(matched(1), 1.0 / 60, {});
  throw_body(soft, {0, 3, 0});
  soft.seconds(1);
  EXPECT_GT(soft.observe("strain.max"), 0.05);
}

TEST(XpbdMatching, LinearGoalsLetABodyShearAndKeepItsVolume) {
  const auto squashed = [](double linear) {
    XpbdDef d = matched(4, linear);
    d.pinned = {"bottom"}, d.damping = 5;
    XpbdRun run(d);
    run.seconds(4);
    return std::pair{run.position(run.state.rows(0) - 1).y, run.observe("volume")};
  };
  const auto [rigid, volume] = squashed(0);
  const auto [linear, kept] = squashed(0.8);
  // g / omega^2 = 15.5 mm on average for rigid goals; linear ones give way by several times as much.
  EXPECT_LT(linear, rigid - 0.01);
  // A fraction of 0.8 of the goals preserves the rest volume: less is lost for the same displacement.
  EXPECT_LT((0.3 - kept) / (0.25 - linear), 0.7 * (0.3 - volume) / (0.25 - rigid));
}

/// A beam of 1 m, 0.25 m square, held at x = 0 and heavy, at rest.
XpbdDef beam(double youngs, double nu) {
  XpbdDef d;
  d.block =
      SoftBlockShape{.origin = {0, 0, 0}, .size = {1, 0.25, 0.25}, .cells_x = 8, .cells_y = 2, .cells_z = 2};
  d.density = 1000, d.youngs_modulus = youngs, d.poisson_ratio = nu;
  d.pinned = {"x0"}, d.damping = 3;
  return d;
}
Vec3 elastic_tip(const XpbdDef& d) {
  XpbdRun run(d);
  run.seconds(8);
  return run.position(run.state.rows(0) - 1) - Vec3{1, 0.25, 0.25};
}
Vec3 element_tip(double youngs, double nu) {
  fem::FemDef d;
  d.block = beam(youngs, nu).block;
  d.element = fem::Cell::tet4, d.material = fem::Law::stable_neo_hookean;
  d.youngs_modulus = youngs, d.poisson_ratio = nu, d.density = 1000;
  d.pinned = {"x0"}, d.motion = fem::Motion::quasi_static;
  FemRun run(d, 1.0 / 60, {0, -9.81, 0});
  run.step(3);
  return run.displacement_at({1, 0.25, 0.25});
}

TEST(XpbdElastic, ABeamBendsAsItsFiniteElements) {
  // The same tetrahedra and lumped masses. The elements' energy has an additional logarithm, of third order
  // in strains of some hundredths: 0.1 % of the displacement. One sweep per substep does not end in
  // equilibrium, by an error of the stiffness times h^2: with four times the substeps a sixteenth.
  for (const double nu : {0.3, 0.45}) {
    XpbdDef d = beam(1e6, nu);
    d.substeps = 40;
    const Vec3 fine = elastic_tip(d), there = element_tip(1e6, nu), coarse = elastic_tip(beam(1e6, nu));
    EXPECT_NEAR(fine.y, there.y, 0.003 * std::abs(there.y)) << nu;
    EXPECT_NEAR(fine.x, there.x, 0.01 * std::abs(there.x)) << nu;
    EXPECT_NEAR(coarse.y, there.y, 0.025 * std::abs(there.y)) << nu;
    EXPECT_LT(std::abs(fine.y - there.y), 0.25 * std::abs(coarse.y - there.y)) << nu;
    // Control: a modulus off by 5 %.
    EXPECT_GT(std::abs(element_tip(1.05e6, nu).y - there.y), 0.03 * std::abs(there.y));
  }
}

TEST(XpbdElastic, AFreeBodyKeepsItsMomentumAndReturnsFromBeingCrushed) {
  XpbdDef d = beam(1e5, 0.45);
  d.pinned.clear();
  XpbdRun run(d, 1.0 / 60, {});
  throw_body(run, {1, 2, 3});
  const double px = run.observe("momentum.x");
  run.seconds(0.5);
  EXPECT_LT(std::abs(run.observe("momentum.x")), px);  // damping
  d.damping = 0;
  XpbdRun free(d, 1.0 / 60, {});
  throw_body(free, {1, 2, 3});
  free.seconds(1);
  EXPECT_NEAR(free.observe("momentum.x"), px, 1e-12 * px);
  d.damping = 1;
  XpbdRun crushed(d, 1.0 / 60, {});
  const auto x = crushed.state.f64(XpbdColumns::position);
  for (size_t k = 1; k < x.size(); k += 3) x[k] *= -0.05;  // flat, and inside out
  crushed.seconds(6);
  EXPECT_TRUE(crushed.finite());
  EXPECT_NEAR(crushed.observe("volume"), 0.0625, 1e-3 * 0.0625);
}

TEST(XpbdSoft, HasTheSameBitsOnTwoThreadsAndFromASnapshot) {
  XpbdDef pile = matched(8, 0.5);
  pile.colliders.push_back(PlaneColliderDef{});
  pile.self_collision = true, pile.thickness = 0.02, pile.iterations = 2;
  for (int k = 0; k < 5; ++k)
    pile.copies.push_back({.position = {0.1 * k, 0.4 + 0.6 * k, 0}, .angle = 0.3 * k});
  XpbdDef elastic = beam(1e5, 0.4);
  elastic.block->cells_x = 40, elastic.block->cells_y = elastic.block->cells_z = 10;
  elastic.iterations = 2;
  for (const XpbdDef& d : {pile, elastic}) {
    XpbdRun one(d), two(d, 1.0 / 60, {0, -9.81, 0}, 2);
    one.step(12), two.step(12);
    EXPECT_EQ(one.state, two.state);
    XpbdRun restored(d);
    restored.state = State::deserialize(one.state.serialize()), restored.steps = one.steps;
    one.step(3), restored.step(3);
    EXPECT_EQ(one.state, restored.state);
    EXPECT_NE(one.state, two.state);
  }
}

TEST(XpbdSoft, WhatMayNotBeSaidIsNamed) {
  const auto faults = [](const XpbdDef& d) {
    std::vector<std::string> out;
    xpbd_table().check(&d, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
    return out;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(faults(matched(2)), Names{});
  EXPECT_EQ(faults(beam(1e5, 0.3)), Names{});
  XpbdDef d = matched(2);
  d.scheme = Scheme::pbd;
  EXPECT_EQ(faults(d), Names{"/matching/frequency"});
  XpbdDef rope;
  rope.rope.emplace(), rope.matching.emplace(), rope.copies.resize(2), rope.poisson_ratio = 0.3;
  EXPECT_EQ(faults(rope), (Names{"/copies", "/matching", "/poisson_ratio"}));
}

}  // namespace
}  // namespace truestep
