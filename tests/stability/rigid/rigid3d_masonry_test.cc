// Structures that stand by their shape alone: arches of dry stones, houses of cards.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/math/trig.h"
#include "tests/support/runs/rigid3d_run.h"

namespace truestep {
using namespace rigid3d;
namespace {

using testing::box;
using testing::ground;
using testing::RigidRun;

constexpr int kSubsteps = 20;
constexpr double kStep = 1.0 / 240;

/// Least ratio of thickness to radius of a standing half circle of masonry (contact.arch, Milankovitch 1907).
constexpr double kLeastThickness = 0.107478038107476;

/// A half circle of stones, 1 m in radius, between two fixed springers. Friction never slips under pressure.
Rigid3dDef arch(double thickness, int stones) {
  Rigid3dDef d;
  d.friction = 1.5, d.sleeping = false, d.substeps = kSubsteps;
  for (int k = -1; k <= stones; ++k) {
    HullBodyDef stone;
    for (const double z : {-0.15, 0.15}) {
      for (const double r : {1 - 0.5 * thickness, 1 + 0.5 * thickness}) {
        for (const int end : {k, k + 1}) {
          const double a = std::numbers::pi * end / stones;
          stone.points.push_back({r * std::cos(a), r * std::sin(a), z});
        }
      }
    }
    if (k == -1 || k == stones) stone.motion = BodyDef::Motion::fixed;
    d.bodies.push_back(stone);
  }
  return d;
}

/// How far (m) the keystone comes down in ten seconds.
double keystone_falls(double share, int stones) {
  RigidRun run(arch(share * kLeastThickness, stones), kStep);
  const auto key = static_cast<size_t>(1 + stones / 2);
  const double before = run.x(key).y;
  run.seconds(10);
  return before - run.x(key).y;
}

TEST(Rigid3dMasonry, AnArchStandsJustAboveTheLeastThicknessAndFallsBelow) {
  for (const int stones : {11, 21}) {
    EXPECT_LT(std::abs(keystone_falls(1.05, stones)), 1e-3) << stones;
    EXPECT_GT(keystone_falls(0.95, stones), 0.5) << stones;
  }
}

constexpr double kHalfCard = 0.044, kHalfThickness = 0.00075, kHalfWidth = 0.03;  // m

/// Cards leaning by 20 degrees in pairs, floors of flat cards between.
Rigid3dDef card_house(int storeys, double friction) {
  Rigid3dDef d;
  d.friction = friction, d.sleeping = false, d.substeps = kSubsteps;
  d.bodies.push_back(ground());
  const double a = std::numbers::pi / 9, s = std::sin(a), c = std::cos(a);
  const double across = kHalfCard * s + kHalfThickness * c, up = kHalfCard * c + kHalfThickness * s;
  const double spacing = 4 * across + 0.002;
  const auto card = [&](double x, double y, double angle, double half) {
    BoxBodyDef b = box({kHalfThickness, half, kHalfWidth}, {x, y, 0});
    b.density = 1000, b.axis = {0, 0, 1}, b.angle = angle;
    d.bodies.push_back(b);
  };
  double y = 0;
  for (int storey = 0; storey < storeys; ++storey) {
    const int pairs = storeys - storey;
    for (int k = 0; k < pairs; ++k) {
      const double x = (k - 0.5 * (pairs - 1)) * spacing;
      card(x - across, y + up, -a, kHalfCard), card(x + across, y + up, a, kHalfCard);
    }
    y += 2 * up;
    for (int k = 0; k + 1 < pairs; ++k) {
      // From ridge to ridge; neighbours do not meet.
      card((k - 0.5 * (pairs - 2)) * spacing, y + kHalfThickness, std::numbers::pi / 2, 0.5 * spacing - 3e-4);
    }
    y += 2 * kHalfThickness;
  }
  return d;
}

/// How far (m) the top comes down in ten seconds.
double house_falls(int storeys, double friction) {
  RigidRun run(card_house(storeys, friction), kStep);
  const size_t top = run.count() - 1;
  const double before = run.x(top).y;
  run.seconds(10);
  return before - run.x(top).y;
}

TEST(Rigid3dMasonry, AHouseOfCardsStands) {
  EXPECT_LT(std::abs(house_falls(4, 0.6)), 1e-4);
  // The control: where the cards meet, the normal is that of one card, and tan(20 degrees) = 0.36 holds it.
  EXPECT_GT(house_falls(4, 0.3), 0.02);
}

/// How far (m) a plank that leans on a smooth wall by 20 degrees comes down in five seconds.
double plank_falls(double friction) {
  Rigid3dDef d;
  d.friction = friction, d.sleeping = false, d.substeps = kSubsteps;
  d.bodies.push_back(ground());
  PlaneBodyDef wall = ground();
  wall.normal = {-1, 0, 0}, wall.friction = 0;
  d.bodies.push_back(wall);
  const double half = 0.44, thick = 0.0075, a = std::numbers::pi / 9, s = std::sin(a), c = std::cos(a);
  BoxBodyDef b = box({thick, half, 0.3}, {-(half * s + thick * c), half * c + thick * s, 0});
  b.axis = {0, 0, 1}, b.angle = -a;
  d.bodies.push_back(b);
  RigidRun run(d, kStep);
  run.seconds(5);
  return b.position.y - run.x(2).y;
}

TEST(Rigid3dMasonry, APlankOnASmoothWallNeedsTheFrictionOfItsStatics) {
  // Moments about its foot: mu = tan(20 degrees) / 2 - thick / (2 half) = 0.17346.
  EXPECT_LT(std::abs(plank_falls(0.175)), 1e-5);
  EXPECT_GT(plank_falls(0.172), 0.3);
}

}  // namespace
}  // namespace truestep
