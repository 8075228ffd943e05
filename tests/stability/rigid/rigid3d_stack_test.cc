// Piles in space stay in place: towers, unequal loads, a pyramid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

using testing::box;
using testing::ground;
using testing::RigidRun;

/// Unit boxes of these masses (kg) stacked on one another.
Rigid3dDef tower(const std::vector<double>& masses) {
  Rigid3dDef d;
  d.sleeping = false;
  d.bodies.push_back(ground());
  for (size_t i = 0; i < masses.size(); ++i) {
    BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5 + static_cast<double>(i), 0});
    b.mass = masses[i];
    d.bodies.push_back(b);
  }
  return d;
}
Rigid3dDef tower(size_t boxes) {
  return tower(std::vector<double>(boxes, 1000));
}

/// m by which the top body is too low, or has moved sideways.
double sunk(const RigidRun& run) {
  const auto top = run.count() - 1;
  return static_cast<double>(top) - 0.5 - run.x(top).y;
}
double aside(const RigidRun& run) {
  const Vec3 x = run.x(run.count() - 1);
  return std::hypot(x.x, x.z);
}
double fastest(const RigidRun& run) {
  double most = 0;
  for (size_t i = 1; i < run.count(); ++i) most = std::max(most, norm(run.v(i)));
  return most;
}

TEST(Rigid3dTower, TenBoxesAtRestAreAsHighAsTheyAre) {
  RigidRun run(tower(10));
  run.seconds(10);
  // contact.stack: 1 mm in total and 0.1 mm/s; MuJoCo's defaults leave 6 mm.
  EXPECT_LT(std::abs(sunk(run)), 1e-3);
  EXPECT_LT(run.observed("penetration"), 1e-3);
  EXPECT_LT(fastest(run), 1e-4);
  EXPECT_LT(aside(run), 1e-4);
  // The control: the effect of springs of 60 Hz on boxes that do not start at rest, before their offsets have
  // grown.
  Rigid3dDef falling = tower(10);
  for (size_t i = 1; i < falling.bodies.size(); ++i) {
    std::get<BoxBodyDef>(falling.bodies[i]).position.y += 1e-3 * static_cast<double>(i);
  }
  RigidRun falls(falling);
  falls.seconds(0.5);
  EXPECT_GT(sunk(falls), 1e-3);
}

TEST(Rigid3dTower, HeavyBoxesOnLightOnesStand) {
  // contact.stack after 5 s, with twenty substeps: MuJoCo's boxes penetrate each other by 49 to 60 mm.
  for (const std::vector<double>& masses : {std::vector<double>{1, 1000}, {1, 10, 100, 1000}}) {
    Rigid3dDef d = tower(masses);
    d.substeps = 20;
    RigidRun run(d);
    run.seconds(5);
    EXPECT_LT(run.observed("penetration"), 1e-3);
    // Offsets that adapt within two seconds are still settling.
    EXPECT_LT(fastest(run), 1e-3);
    EXPECT_LT(aside(run), 1e-5);
    run.seconds(10);
    EXPECT_LT(fastest(run), 1e-4);
    // The control: contacts that are too soft for a thousandfold load.
    d.contact_hertz = 10;
    RigidRun soft(d);
    soft.seconds(5);
    EXPECT_GT(soft.observed("penetration"), 1e-3);
  }
}

TEST(Rigid3dTower, FiftyBoxesStandForAMinute) {
  Rigid3dDef d = tower(50);
  d.substeps = 20;
  // A tiny velocity, so that it does not stand by symmetry alone.
  std::get<BoxBodyDef>(d.bodies.back()).velocity = {1e-5, 0, 0};
  RigidRun run(d);
  run.seconds(60);
  EXPECT_LT(aside(run), 1e-4);
  EXPECT_LT(std::abs(sunk(run)), 1e-3);
  // The control: a column of springs of 15 Hz buckles above eight boxes.
  d.contact_hertz = 15;
  RigidRun soft(d);
  soft.seconds(30);
  EXPECT_GT(aside(soft), 0.1);
}

/// m by which the top has moved after 40 s of columns of blocks, 40 cm thick and 50 cm high, each turned by
/// 15 degrees relative to the one below: four points on a slant bear it.
double moved_top_of_turned_blocks(size_t courses, std::optional<double> hertz) {
  Rigid3dDef d;
  d.sleeping = false, d.precision = Rigid3dDef::Precision::f64, d.contact_hertz = hertz;
  d.bodies.push_back(ground());
  for (size_t k = 0; k < courses; ++k) {
    BoxBodyDef b = box({0.43, 0.25, 0.2}, {0, 0.25 + 0.5 * static_cast<double>(k), 0});
    b.density = 2000;
    b.axis = {0, 1, 0}, b.angle = k % 2 ? std::numbers::pi / 12 : 0;
    // 2e-10 J, so that it does not stand by symmetry alone.
    if (k + 1 == courses) b.velocity = {0, 0, 1e-6};
    d.bodies.push_back(b);
  }
  RigidRun run(d);
  const Vec3 start = run.x(run.count() - 1);
  run.seconds(40);
  return norm(run.x(run.count() - 1) - start);
}

TEST(Rigid3dTower, TurnedBlocksStand) {
  // Without additional substeps the energy of the twelve grows by 1.6/s: they fall within 40 s.
  EXPECT_LT(moved_top_of_turned_blocks(12, {}), 1e-4);
  EXPECT_LT(moved_top_of_turned_blocks(18, {}), 1e-4);
  // The control: contacts that are not made stiffer.
  EXPECT_GT(moved_top_of_turned_blocks(12, 10), 0.1);
}

TEST(Rigid3dTower, TwentySmallBoxesStand) {
  // Boxes of 10 cm buckle above eight with the contacts of five substeps: each bears less than twenty.
  Rigid3dDef d;
  d.sleeping = false;
  d.bodies.push_back(ground());
  for (size_t i = 0; i < 20; ++i)
    d.bodies.push_back(box({0.05, 0.05, 0.05}, {0, 0.05 + 0.1 * static_cast<double>(i), 0}));
  RigidRun run(d);
  run.seconds(2);
  const double at_first = aside(run);
  run.seconds(58);
  // It leant by 5 mm in its first second, while a substep was added every fourth step, and by 1 mm where the
  // first step still had five. The control: it falls with contacts that stay as they are.
  EXPECT_LT(at_first, 1e-5);
  EXPECT_LT(aside(run), 1e-4);
  d.contact_hertz = 39;
  RigidRun soft(d);
  soft.seconds(60);
  EXPECT_GT(aside(soft), 0.1);
}

TEST(Rigid3dTower, APyramidIsStill) {
  Rigid3dDef d;
  d.sleeping = false;
  d.bodies.push_back(ground());
  BoxBodyDef b = box({0.5, 0.5, 0.5}, {0, 0.5, 0});
  b.copies = CopiesDef{};
  b.copies->layout = CopiesDef::Layout::pyramid, b.copies->count = {15}, b.copies->spacing = {1.05, 1, 1.05};
  d.bodies.push_back(b);
  RigidRun run(d);
  const Vec3 start = run.x(run.count() - 1);
  run.seconds(3);
  // The top of 1240 boxes; Rapier's moves by 2.6 mm.
  EXPECT_LT(norm(run.x(run.count() - 1) - start), 4e-3);
  EXPECT_LT(run.observed("penetration"), 1e-3);
  EXPECT_LT(fastest(run), 0.01);
  // The control: springs near half the substeps' rate tremble once they are shaken, here by courses that
  // start a millimetre apart; ours come to rest.
  std::get<BoxBodyDef>(d.bodies.back()).copies->spacing = {1.05, 1.001, 1.05};
  RigidRun shaken(d);
  shaken.seconds(3);
  EXPECT_LT(fastest(shaken), 0.01);
  d.contact_hertz = 150;
  RigidRun stiff(d);
  stiff.seconds(3);
  EXPECT_GT(fastest(stiff), 0.02);
}

}  // namespace
}  // namespace truestep
