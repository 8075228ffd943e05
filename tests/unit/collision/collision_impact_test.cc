// Nothing passes anything: ten thousand shots against fine stepping.
#include <gtest/gtest.h>

#include "engine/collision/collision.h"
#include "tests/unit/collision/collision_rig.h"

namespace truestep {
namespace {

using namespace collision_rig;

struct Tally {
  int shots = 0, hits = 0, seen_at_end = 0;
};

/// Fires one shot and compares it with `steps` samples along the path.
void shoot(const Solid& a, const Sweep& sa, const Solid& b, const Sweep& sb, int steps, Tally& tally,
           const std::string& what) {
  constexpr double kTouch = 1e-4;
  const auto impact = time_of_impact(a, sa, b, sb, kTouch);
  std::vector<Manifold> found;
  const auto overlaps = [&](double t) {
    found.clear();
    return collide(a, sa.at(t), b, sb.at(t), 0, found) > 0;
  };
  double first = 2;
  for (int k = 0; k <= steps && first > 1; ++k) {
    if (overlaps(static_cast<double>(k) / steps)) first = static_cast<double>(k) / steps;
  }
  ++tally.shots;
  tally.hits += first <= 1;
  tally.seen_at_end += overlaps(1);
  if (!impact) {
    EXPECT_GT(first, 1) << what << " missed";
    return;
  }
  EXPECT_LE(impact->t, first) << what << " late";
  EXPECT_NEAR(norm(impact->normal), 1, 1e-12);
  if (impact->t > 0) {
    // It stops while there is still a gap, and a small one.
    EXPECT_GT(impact->gap, 0.49 * kTouch) << what;
    EXPECT_LE(impact->gap, kTouch) << what;
    EXPECT_FALSE(overlaps(impact->t)) << what;
  }
}

/// From a point on a sphere of radius 3 to near its other side.
Sweep shot(uint64_t stream, uint64_t i, double length, double turn) {
  const Vec3 from = random_unit(stream, i) * 3.0, aim = random_unit(stream + 1, i) * 0.8;
  return {{from, random_quat(stream, i)}, normalized(aim - from) * length, random_unit(stream + 2, i) * turn};
}

TEST(TimeOfImpact, BallsAt300MetresASecondAndWallsOfACentimetre) {
  Tally tally;
  const Solid wall = box_solid({1, 1, 0.005});
  for (uint64_t i = 0; i < 5000; ++i) {
    const Solid ball = sphere_solid(i % 2 ? 0.1 : 0.01);
    const Sweep w = i % 3 ? resting({{}, random_quat(1, i)})
                          : sweep_between({{}, random_quat(1, i)}, {{0.3, 0, 0}, random_quat(2, i)});
    shoot(wall, w, ball, shot(10, i, 5, 0), i % 2 ? 100 : 800, tally, "ball " + std::to_string(i));
  }
  EXPECT_GT(tally.hits, 1500);
  // Control: checking the end only, as a solver without a sweep does, finds next to none of them.
  EXPECT_LT(tally.seen_at_end, tally.hits / 20);
}

TEST(TimeOfImpact, SpinningNeedlesPlatesAndTheRest) {
  Tally tally;
  for (uint64_t i = 0; i < 4000; ++i) {
    const int ka = static_cast<int>(i % kSolids), kb = static_cast<int>(i / kSolids % kSolids);
    const Sweep a{{{}, random_quat(3, i)}, random_unit(4, i), random_unit(5, i) * 2.0};
    shoot(sample_solid(ka, i, 1), a, sample_solid(kb, i + 7, 0.7), shot(20, i, 5, 3), 120, tally,
          "pair " + std::to_string(ka) + " " + std::to_string(kb) + " " + std::to_string(i));
  }
  EXPECT_GT(tally.hits, 1500);
}

TEST(TimeOfImpact, MeshesHeightFieldsPlanesAndCompounds) {
  Tally tally;
  std::vector<double> heights(81);
  for (size_t k = 0; k < 81; ++k) heights[k] = 0.6 * uniform4(1, 2, k)[0];
  const Solid field = height_field_solid(9, 9, 2, heights);
  // Closed and thin.
  const Solid mesh = mesh_solid({{1, 0, 0}, {-0.5, 0, 0.87}, {-0.5, 0, -0.87}, {0, 0.02, 0}},
                                {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0});
  const Solid pair = compound_solid(
      {{box_solid({0.6, 0.004, 0.3}), {{0.3, 0, 0}, {}}}, {sphere_solid(0.2), {{-0.5, 0, 0}, {}}}});
  const Solid* targets[] = {&field, &mesh, &pair};
  for (uint64_t i = 0; i < 1500; ++i) {
    const Solid& target = *targets[i % 3];
    Sweep s = shot(30, i, 5, i % 2 ? 0 : 2);
    if (i % 3 == 0) s.from.position.y = std::fabs(s.from.position.y) + 1.5, s.move.y = -std::fabs(s.move.y);
    const Solid body = i % 5 == 4 ? pair : sample_solid(static_cast<int>(i % 5), i, 0.3);
    shoot(target, resting({}), body, s, 150, tally, "target " + std::to_string(i));
  }
  EXPECT_GT(tally.hits, 500);
  for (uint64_t i = 0; i < 500; ++i) {
    Sweep s = shot(40, i, 6, 2);
    s.from.position.y = 3, s.move.y = -5;
    const Solid body = sample_solid(static_cast<int>(i % kSolids), i, 1);
    const auto hit = time_of_impact(body, s, plane_solid({0, 1, 0}), resting({}), 1e-4);
    ASSERT_TRUE(hit) << i;
    const Placed there{body, s.at(hit->t)};
    const auto low = static_cast<double>(-reach(there, {0, -1, 0}));
    EXPECT_GT(low, 0.49e-4);
    EXPECT_LE(low, 1.001e-4);
    EXPECT_LT(norm(hit->normal - Vec3{0, -1, 0}), 1e-12);
  }
}

TEST(TimeOfImpact, BallAndPlaneInOneRound) {
  const auto hit = time_of_impact(plane_solid({0, 1, 0}), resting({}), sphere_solid(0.1),
                                  {{{0, 2.1, 0}, {}}, {7, -4, 1}, {0, 0, 3}}, 1e-6);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 0.5, 0.51e-6 / 4);
  EXPECT_NEAR(hit->point.x, 3.5, 1e-6);
}

TEST(Sweep, ReachesItsEndByTheShorterWay) {
  for (uint64_t i = 0; i < 500; ++i) {
    const Pose a{random_unit(1, i), random_quat(50, i)}, b{random_unit(2, i), random_quat(51, i)};
    const Sweep s = sweep_between(a, b);
    EXPECT_LE(norm(s.turn), 3.1415926535897936);
    const Transform end = s.at(1), expected = transform_of(b);
    for (int k = 0; k < 3; ++k) EXPECT_LT(norm(end.rotation.row[k] - expected.rotation.row[k]), 1e-14);
    EXPECT_LT(norm(end.position - expected.position), 1e-15);
  }
}

}  // namespace
}  // namespace truestep
