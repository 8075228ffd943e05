// A box that lies on a link of a chain touches it at two points. A link's face is on the left of its
// direction, where a polygon's is on the right, so that the two facing edges run the same way: mistaken for
// edges seen end-on, they used to touch at one point, and boxes trembled and sank in by centimetres.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/collision/flat/contact.h"
#include "engine/systems/rigid2d/rigid2d_def.h"
#include "tests/support/runs/engine_run.h"

namespace truestep::flat {
namespace {

TEST(FlatLink, ABoxOrACapsuleLiesOnTwoPoints) {
  const std::vector<Vec2> points{{-30, 0}, {30, 0}};
  const Outline link = chain(points, Ends::open)[0];
  for (const Outline& body :
       {box(0.5, 0.1), box(0.4, 0.05, {}, {}, 0.05), capsule({-0.5, 0}, {0.5, 0}, 0.1)}) {
    for (const double turn : {0.0, 0.005, -0.005}) {
      const Pose at{{12, 0.095}, {std::cos(turn), std::sin(turn)}};
      Contact c;
      ASSERT_TRUE(touch(link, body, at, 0.02, c));
      ASSERT_EQ(c.points, 2u) << turn;
      EXPECT_NEAR(c.normal.y, 1, 1e-4);
      // Under its ends, one on each side.
      EXPECT_LT((c.point[0].at.x - 12) * (c.point[1].at.x - 12), -0.1);
      EXPECT_NE(c.point[0].id, c.point[1].id);
      // The same seen from the body.
      Contact back;
      ASSERT_TRUE(touch(body, link, at.to(Pose{}), 0.02, back));
      EXPECT_EQ(back.points, 2u) << turn;
    }
  }
}

TEST(FlatLink, ThinBoxesRestOnAChainAsOnABox) {
  for (const double half : {0.3, 0.1, 0.03}) {
    rigid2d::Rigid2dDef d;
    rigid2d::BodyDef floor, thin;
    floor.motion = rigid2d::Motion::fixed;
    floor.shapes = {rigid2d::ChainDef{{{-30, 0, 0}, {-5, 0, 0}, {5, 0, 0}, {30, 0, 0}}}};
    thin.shapes = {rigid2d::BoxDef{{0.5, half, 0}}}, thin.position = {12, half + 0.01, 0};
    d.bodies = {floor, thin};
    truestep::testing::EngineRun r = truestep::testing::ours(d);
    r.seconds(2);
    // Soft contacts give way by some 0.05 mm under a body's weight.
    EXPECT_NEAR(r.x(1).y, half, 2e-4) << half;
    EXPECT_LT(norm(r.v(1)), 1e-4) << half;
  }
}

}  // namespace
}  // namespace truestep::flat
