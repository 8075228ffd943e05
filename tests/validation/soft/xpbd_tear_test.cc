// Cloth of the system xpbd that tears: where it does, what it conserves, and that it leaves intact cloth
// alone.
#include <algorithm>

#include "engine/base/errors.h"
#include "engine/core/state/state_check.h"
#include "tests/unit/soft/xpbd_rig.h"

namespace truestep {
using namespace xpbd;
namespace {

using testing_rig::XpbdRun;

/// A strip of 5 x 21 points, 0.2 m x 1 m, that hangs from its last row.
XpbdDef strip(std::optional<TearDef> tear) {
  XpbdDef d;
  d.cloth_grid =
      ClothGridShape{.origin = {0, 0, 0}, .edge_u = {0.2, 0, 0}, .edge_v = {0, 1, 0}, .nx = 5, .ny = 21};
  d.mass = 0.01, d.stiffness = 500, d.shear_stiffness = 100, d.internal_damping = 1;
  d.pinned = {"edge_v1"};
  d.tear = std::move(tear);
  return d;
}

double total(const XpbdRun& run, std::string_view column) {
  double sum = 0;
  for (const double m : run.state.f64(run.state.at(column))) sum += m;
  return sum;
}

/// A free sheet that is torn to pieces by its own velocities.
XpbdDef bursting(Precision precision = Precision::f64) {
  XpbdDef d;
  d.cloth_grid = ClothGridShape{.origin = {-0.5, 0, -0.5}, .nx = 33, .ny = 29, .shear = ShearSprings::both};
  d.density = 0.2, d.stiffness = 100, d.shear_stiffness = 20, d.flexural_rigidity = 1e-5;
  d.tear = TearDef{.strain = 0.1};
  d.precision = precision;
  return d;
}
void spread(XpbdRun& run) {
  const auto v = run.state.f64(XpbdColumns::velocity);
  for (size_t i = 0; i < v.size() / 3; ++i) {
    const Vec3 x = run.position(i);
    // Apart, around, and together along x.
    store3(v.data(), i, {1 + 15 * x.x - 5 * x.z, 3 * x.x * x.x, 15 * x.z + 5 * x.x});
  }
}

TEST(XpbdTear, BelowItsLimitsNothingIsChangedToTheBit) {
  for (const auto scheme : {Scheme::xpbd, Scheme::pbd}) {
    XpbdDef with = strip(TearDef{.strain = 10}), without = strip({});
    with.scheme = without.scheme = scheme;
    XpbdRun a(with), b(without);
    a.step(40), b.step(40);
    const auto same = [&](State::Column c) { return std::ranges::equal(a.state.f64(c), b.state.f64(c)); };
    EXPECT_TRUE(same(XpbdColumns::position));
    EXPECT_TRUE(same(XpbdColumns::velocity));
    EXPECT_EQ(a.observe("splits"), 0);
    EXPECT_EQ(a.observe("strain.max"), b.observe("strain.max"));
    EXPECT_EQ(a.observe("energy.kinetic"), b.observe("energy.kinetic"));
  }
}

TEST(XpbdTear, AHangingStripTearsWhereItBearsMost) {
  // The five links at the top carry 20 x 0.01 x 9.81 N each on average and twice that at the lowest point of
  // the bounce after the release; those below carry a twentieth less from row to row.
  const double load = 20 * 0.01 * 9.81;
  XpbdRun torn(strip(TearDef{.force = 1.2 * load}));
  double highest = 0;
  for (int k = 0; k < 60; ++k) {
    torn.step();
    highest = std::max(highest, torn.observe("splits"));
  }
  EXPECT_GE(highest, 5);
  // The held row cannot split: the row below it does, before any other.
  const auto origin = torn.state.span<uint32_t>(torn.state.at("origin"));
  EXPECT_TRUE(
      std::all_of(origin.begin() + 105, origin.begin() + 110, [](uint32_t p) { return p / 5 >= 18; }));
  // Everything below has been in free fall since: a second's fall, less the time until it tore.
  EXPECT_LT(torn.position(2).y, -1);
  // Control: a limit that the bounce does not reach.
  XpbdRun holds(strip(TearDef{.force = 3 * load}));
  holds.step(60);
  EXPECT_EQ(holds.observe("splits"), 0);
  EXPECT_GT(holds.position(2).y, -0.3);
}

TEST(XpbdTear, MassAndMomentumStay) {
  for (const Precision precision : {Precision::f64, Precision::f32}) {
    XpbdRun run(bursting(precision), 1.0 / 120, {});
    spread(run);
    const double mass = total(run, "mass"), px = run.observe("momentum.x"), pz = run.observe("momentum.z");
    const double ly = run.observe("angular_momentum.y");
    run.step(40);
    EXPECT_GT(run.observe("splits"), 50);
    // Sums of a thousand numbers; in floats, displacements and velocities are rounded at 6e-8 per step.
    const double rounding = precision == Precision::f64 ? 1e-12 : 1e-5;
    EXPECT_NEAR(total(run, "mass"), mass, 1e-13 * mass);
    EXPECT_NEAR(run.observe("momentum.x"), px, rounding * px);
    EXPECT_NEAR(run.observe("momentum.z"), pz, rounding * px);
    // Conserved only to first order in the substep, as without tears.
    EXPECT_NEAR(run.observe("angular_momentum.y"), ly, 0.03 * std::abs(ly));
    EXPECT_TRUE(run.finite());
  }
}

TEST(XpbdTear, ASplitChangesNeitherEnergyNorMomenta) {
  XpbdDef d = bursting();
  d.flexural_rigidity = 0;  // what bends across a tear is gone
  XpbdRun run(d, 1.0 / 120, {});
  spread(run);
  const auto x = run.state.f64(XpbdColumns::position);
  for (size_t k = 0; k < x.size(); k += 3) x[k] *= 1.3;
  const auto all = [&] {
    return std::array{run.observe("energy.kinetic"),     run.observe("energy.potential"),
                      run.observe("momentum.x"),         run.observe("angular_momentum.x"),
                      run.observe("angular_momentum.y"), run.observe("angular_momentum.z")};
  };
  const auto before = all();
  TearSurface surface(run.system->body());
  surface.columns = {run.state.at("mass"), run.state.at("origin"), run.state.at("corner")};
  Tearing tearing;
  tearing.run(surface, run.system->body(), {0.1, HUGE_VAL}, run.state, run.state.f64(XpbdColumns::stiffness));
  EXPECT_GT(run.observe("splits"), 50);
  const auto after = all();
  // Only diagonals across two triangles that separate are gone: at most their share of the energy.
  EXPECT_LE(after[1], before[1]);
  EXPECT_GT(after[1], 0.8 * before[1]);
  for (const size_t k : {0, 2, 3, 4, 5})
    EXPECT_NEAR(after[k], before[k], 1e-12 * (1 + std::abs(before[k]))) << k;
}

TEST(XpbdTear, HasTheSameBitsOnTwoThreadsAndFromASnapshot) {
  for (const Precision precision : {Precision::f64, Precision::f32}) {
    XpbdRun one(bursting(precision)), two(bursting(precision), 1.0 / 60, {0, -9.81, 0}, 2);
    spread(one), spread(two);
    one.step(6), two.step(6);
    EXPECT_GT(one.observe("splits"), 10);
    EXPECT_EQ(one.state, two.state);
    XpbdRun restored(bursting(precision));
    restored.step(3);  // another cloth was in its scratch
    restored.state = State::deserialize(one.state.serialize()), restored.steps = one.steps;
    StateCheck check(restored.state, restored.system->initial_state());
    restored.system->check(check, 0);
    EXPECT_NO_THROW(check.finish());
    one.step(6), restored.step(6);
    EXPECT_GT(one.observe("splits"), 20);
    EXPECT_EQ(one.state, restored.state);
    // And back to before anything tore.
    restored.state = restored.system->initial_state(), restored.steps = 0;
    XpbdRun fresh(bursting(precision));
    restored.step(3), fresh.step(3);
    EXPECT_EQ(fresh.state, restored.state);
  }
}

TEST(XpbdTear, StopsWhereThereIsNoMoreRoom) {
  XpbdDef d = bursting();
  d.tear->most_splits = 7;
  XpbdRun run(d, 1.0 / 120, {});
  spread(run);
  run.step(40);
  EXPECT_EQ(run.observe("splits"), 7);
  EXPECT_TRUE(run.finite());
}

TEST(XpbdTear, AStateThatDoesNotFitIsRefused) {
  XpbdRun run(bursting());
  const auto refused = [&](const State& s) {
    StateCheck check(s, run.system->initial_state());
    EXPECT_THROW((run.system->check(check, 0), check.finish()), Error);
  };
  State wrong = run.state;
  wrong.span<uint32_t>(wrong.at("corner"))[0] = 5;
  refused(wrong);
  wrong = run.state, wrong.span<uint32_t>(wrong.at("corner"))[0] = 100'000;
  refused(wrong);
  wrong = run.state, wrong.f64(wrong.at("mass"))[3] = 0;
  refused(wrong);
}

TEST(XpbdTear, TheWindPushesEveryPieceThatItHasTornOff) {
  XpbdDef d = bursting();
  d.wind = Vec3{};
  XpbdRun run(d, 1.0 / 60, {});
  spread(run);
  run.step(20);
  ASSERT_GT(run.observe("splits"), 20);
  // Laid still in place, with the wind straight up: a step gives 1/2 rho C h sum A (n . u)^2 n over
  // triangles.
  const auto v = run.state.f64(XpbdColumns::velocity), x = run.state.f64(XpbdColumns::position);
  std::fill(v.begin(), v.end(), 0.0);
  const double u = 1e-3, h = 1e-6;
  double expected = 0;
  const auto corner = run.state.span<uint32_t>(run.state.at("corner"));
  for (size_t t = 0; t < corner.size(); t += 3) {
    const Vec3 o = load3(x.data(), corner[t]);
    const Vec3 area2 = cross(load3(x.data(), corner[t + 1]) - o, load3(x.data(), corner[t + 2]) - o);
    const double un = u * area2.y / norm(area2);
    expected += 0.5 * 1.2 * 1.2 * h * 0.5 * std::abs(un) * un * area2.y;
  }
  run.system->apply(run.state, {.kind = CommandKind::set_parameter, .vector = {0, u, 0}, .name = "wind"});
  XpbdRun still(d, h, {});
  still.state = run.state;
  still.step();
  // Links are stretched and pull internally, which sums to rounding of 1e-16 of 100 N and 1e-6 s on 3e-9 N s;
  // the implicit factor is one within 1e-9.
  EXPECT_NEAR(still.observe("momentum.y"), expected, 1e-6 * expected);
  EXPECT_GT(expected, 0);
}

TEST(XpbdTear, WhatMayNotBeSaidIsNamed) {
  const auto faults = [](const XpbdDef& d) {
    std::vector<std::string> out;
    xpbd_table().check(&d, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
    return out;
  };
  using Names = std::vector<std::string>;
  XpbdDef d = strip(TearDef{.strain = 0.1});
  EXPECT_EQ(faults(d), Names{});
  // Torn cloth collides with itself, too.
  d.self_collision = true, d.wind = Vec3{};
  EXPECT_EQ(faults(d), Names{});
  d = strip(TearDef{.force = 1});
  d.scheme = Scheme::pbd;
  EXPECT_EQ(faults(d), Names{"/tear/force"});
  XpbdDef rope;
  rope.rope.emplace(), rope.tear = TearDef{.strain = 1};
  EXPECT_EQ(faults(rope), Names{"/tear"});
  const TearDef none;
  std::vector<std::string> out;
  tear_table().check(&none, [&](const std::string& pointer, const std::string&) { out.push_back(pointer); });
  EXPECT_EQ(out, Names{""});
}

}  // namespace
}  // namespace truestep
