// Cloth on cloth: thrown at 20 m/s, folded into a heap, and a rope on itself. No edge may ever pierce a
// triangle, at any speed; sheets at rest on each other keep their thickness.
#include <cmath>

#include "tests/unit/soft/xpbd_sheets.h"

namespace truestep {
using namespace xpbd;
namespace {

using testing_rig::add_sheet;
using testing_rig::piercings;
using testing_rig::XpbdRun;

constexpr int64_t kWide = 31, kSmall = 16;

/// A sheet held at its rim, 4 mm thick, points 30 mm apart, and above it a smaller one at a slight angle.
XpbdDef thrown(Precision precision) {
  XpbdDef d;
  d.mesh.emplace();
  add_sheet(*d.mesh, {-0.45, 0, -0.45}, {0.03, 0, 0}, {0, 0, 0.03}, kWide);
  add_sheet(*d.mesh, {-0.22, 0.2, -0.21}, {0.028, 0.004, 0.003}, {-0.002, 0.003, 0.029}, kSmall);
  d.density = 0.2, d.stiffness = 2000, d.thickness = 0.004;
  d.flexural_rigidity = 1e-5;
  for (int64_t i = 0; i < kWide; ++i) {
    for (const int64_t p : {i, (kWide - 1) * kWide + i, i * kWide, i * kWide + kWide - 1})
      d.pins.push_back(p);
  }
  d.self_collision = true;
  d.precision = precision;
  return d;
}

void throw_down(XpbdRun& run, double speed) {
  for (size_t i = kWide * kWide; i < run.system->body().x.size(); ++i) {
    run.state.f64(XpbdColumns::velocity)[3 * i + 1] = -speed;
  }
}

double lowest_of_small(const XpbdRun& run) {
  double low = HUGE_VAL;
  for (size_t i = kWide * kWide; i < run.system->body().x.size(); ++i) low = std::min(low, run.position(i).y);
  return low;
}

class XpbdSelfCollision : public ::testing::TestWithParam<Precision> {};
INSTANTIATE_TEST_SUITE_P(Precisions, XpbdSelfCollision, ::testing::Values(Precision::f64, Precision::f32));

TEST_P(XpbdSelfCollision, ClothThrownOnClothAtTwentyMetresASecondStaysOnIt) {
  for (const double speed : {20.0, 60.0}) {
    XpbdRun run(thrown(GetParam()));
    throw_down(run, speed);
    for (int k = 0; k < 60; ++k) {
      run.step();
      ASSERT_TRUE(run.finite());
      ASSERT_EQ(piercings(run), 0u) << "step " << k;
    }
    // The held sheet reaches at most half a metre, including its stretch in the impact; whatever has come
    // through falls from there.
    EXPECT_GT(lowest_of_small(run), -2.0) << speed;
  }
}

/// Number of edges of one sheet through triangles of the other, in their torn state.
size_t through_each_other(const XpbdRun& run) {
  const auto corner = run.state.span<uint32_t>(run.state.at("corner"));
  std::vector<std::array<uint32_t, 3>> triangles;
  for (size_t k = 0; k < corner.size(); k += 3)
    triangles.push_back({corner[k], corner[k + 1], corner[k + 2]});
  constexpr size_t kFirst = 2 * (kWide - 1) * (kWide - 1);
  return testing_rig::piercings_of(run, triangles,
                                   [](size_t a, size_t b) { return (a < kFirst) != (b < kFirst); });
}

TEST(XpbdSelfCollisionTorn, SheetsThatTearAsTheyMeetDoNotPassEachOther) {
  // Self-collision is off next to the lips of a tear; the sheets themselves never pass each other. Steps are
  // so short that a sheet passing through would be seen. Strain and speed are chosen so that the sheet tears,
  // and passes without self_collision.
  XpbdDef d = thrown(Precision::f64);
  d.tear = TearDef{.strain = 0.02};
  XpbdRun run(d, 1.0 / 240);
  throw_down(run, 5);
  for (int k = 0; k < 40; ++k) {
    run.step();
    ASSERT_TRUE(run.finite());
    ASSERT_EQ(through_each_other(run), 0u) << "step " << k;
  }
  EXPECT_GT(run.observe("splits"), 3);
  d.self_collision = false;
  XpbdRun open(d, 1.0 / 240);
  throw_down(open, 5);
  size_t without = 0;
  for (int k = 0; k < 40; ++k) open.step(), without += through_each_other(open);
  EXPECT_GT(without, 0u);
}

TEST(XpbdSelfCollisionControl, ClothThatDoesNotAskGoesThrough) {
  XpbdDef d = thrown(Precision::f64);
  d.self_collision = false;
  XpbdRun run(d);
  throw_down(run, 20);
  run.step(60);
  EXPECT_LT(lowest_of_small(run), -15);
}

TEST_P(XpbdSelfCollision, ClothDroppedOnASphereFoldsWithoutPiercing) {
  XpbdDef d;
  d.cloth_grid = ClothGridShape{
      .origin = {-0.5, 0.55, -0.5}, .edge_u = {1, 0, 0}, .edge_v = {0, 0, 1}, .nx = 31, .ny = 31};
  d.density = 0.2, d.stiffness = 2000, d.shear_stiffness = 500, d.flexural_rigidity = 1e-5;
  d.thickness = 0.01, d.self_collision = true;
  d.damping = 1e-4;
  d.colliders.push_back(SphereColliderDef{{}, {0, 0.3, 0}, 0.15, false});
  d.colliders.push_back(PlaneColliderDef{});
  d.precision = GetParam();
  XpbdRun run(d), open([&] {
    d.self_collision = false;
    return d;
  }());
  size_t without = 0;
  for (int k = 0; k < 150; ++k) {
    run.step(), open.step();
    ASSERT_TRUE(run.finite());
    ASSERT_EQ(piercings(run), 0u) << "step " << k;
    without += piercings(open);
  }
  // The control: without self-collision the same cloth passes through itself as it folds.
  EXPECT_GT(without, 100u);
  // At rest, with its links at their lengths.
  EXPECT_LT(run.observe("strain.rms"), 0.02);
}

TEST_P(XpbdSelfCollision, SheetsOnEachOtherKeepTheirThickness) {
  XpbdDef d;
  d.mesh.emplace();
  for (int k = 0; k < 3; ++k) {
    add_sheet(*d.mesh, {0.003 * k, 0.01 + 0.02 * k, 0.005 * k}, {0.03, 0, 0}, {0, 0, 0.03}, 9);
  }
  d.density = 0.2, d.thickness = 0.008, d.self_collision = true;
  d.colliders.push_back(PlaneColliderDef{});
  d.precision = GetParam();
  XpbdRun run(d);
  run.seconds(2);
  double mean[3] = {};
  for (size_t i = 0; i < 243; ++i) mean[i / 81] += run.position(i).y / 81;
  // The lowest sheet is half a thickness above the floor, each further one a whole thickness higher; a weight
  // of grams compresses by h^2 g per substep.
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(mean[k], 0.004 + 0.008 * k, 1e-4) << k;
  EXPECT_LT(run.observe("energy.kinetic"), 1e-4);
  EXPECT_EQ(piercings(run), 0u);
}

/// Largest slip (m) in a second of the upper of two level sheets, the lower one held, under tilted gravity.
double slip(double friction, double lean) {
  XpbdDef d;
  d.mesh.emplace();
  add_sheet(*d.mesh, {}, {0.03, 0, 0}, {0, 0, 0.03}, 21);
  add_sheet(*d.mesh, {0.1, 0.008, 0.15}, {0.03, 0, 0}, {0, 0, 0.03}, 6);
  for (int64_t i = 0; i < 441; ++i) d.pins.push_back(i);
  d.density = 0.2, d.thickness = 0.008, d.self_collision = true, d.self_friction = friction;
  XpbdRun run(d, 1.0 / 60, Vec3{std::sin(lean), -std::cos(lean), 0} * 9.81);
  run.seconds(0.25);
  return run.position(441 + 14).x - 0.1 - 0.06;
}

TEST(XpbdSelfCollisionFriction, HoldsBelowItsConeAndSlidesAboveIt) {
  const double lean = 0.3;  // tan = 0.309
  // s = 1/2 g (sin - mu cos) t^2, delayed by whole steps of h: 1 / 150 of it.
  const double free = 0.5 * 9.81 * std::sin(lean) * 0.0625,
               held = 0.5 * 9.81 * (std::sin(lean) - 0.15 * std::cos(lean)) * 0.0625;
  // Held by friction, it creeps as the sheets' separation yields under its weight: a fiftieth of the free
  // slide.
  EXPECT_LT(slip(0.4, lean), 0.02 * free);
  EXPECT_NEAR(slip(0, lean), free, 0.03 * free);
  EXPECT_NEAR(slip(0.15, lean), held, 0.05 * free);
}

TEST_P(XpbdSelfCollision, FreeSheetsKeepTheirMomentum) {
  XpbdDef d;
  d.mesh.emplace();
  add_sheet(*d.mesh, {}, {0.03, 0, 0}, {0, 0, 0.03}, 11);
  add_sheet(*d.mesh, {0.05, 0.05, 0.02}, {0.03, 0.002, 0}, {0, 0.003, 0.03}, 9);
  d.density = 0.2, d.thickness = 0.004, d.self_collision = true;
  d.precision = GetParam();
  XpbdRun run(d, 1.0 / 60, {});
  for (size_t i = 121; i < 202; ++i) run.state.f64(XpbdColumns::velocity)[3 * i + 1] = -20;
  const double before = run.observe("momentum.y"), energy = run.observe("energy.kinetic");
  run.step(60);
  // Rounding of some hundred substeps; displacements in floats, a millionth each.
  const double tolerance = GetParam() == Precision::f64 ? 1e-12 : 1e-4;
  EXPECT_NEAR(run.observe("momentum.y"), before, tolerance * std::abs(before));
  EXPECT_NEAR(run.observe("momentum.x"), 0, tolerance * std::abs(before));
  // No energy is gained: an impact without bounce.
  EXPECT_LT(run.observe("energy.kinetic"), energy);
}

}  // namespace
}  // namespace truestep
