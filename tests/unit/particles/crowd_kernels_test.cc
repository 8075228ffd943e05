// Velocities in half-planes against an oracle that tries every corner, ORCA's planes against their
// definition, and social forces against the paper's formula.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/base/random.h"
#include "engine/kernels/crowd/orca.h"
#include "engine/kernels/crowd/segment.h"
#include "engine/kernels/crowd/social_force.h"

namespace truestep::crowd {
namespace {

constexpr double kTurn = 6.283185307179586;

std::vector<HalfPlane> random_planes(uint64_t seed, size_t n, double furthest) {
  std::vector<HalfPlane> out;
  for (size_t k = 0; k < n; ++k) {
    const auto u = uniform4(seed, 1, k);
    out.push_back({{std::cos(kTurn * u[0]), std::sin(kTurn * u[0]), 0}, furthest * (2 * u[1] - 1.6)});
  }
  return out;
}

bool keeps(const std::vector<HalfPlane>& planes, double speed, const Vec3& v, double slack) {
  for (const HalfPlane& p : planes) {
    if (p.lack(v) > slack) return false;
  }
  return norm(v) <= speed + slack;
}

/// Every point where an optimum can lie: the wish, its projections onto lines and the circle, intersections
/// of two lines, and of a line and the circle.
std::vector<Vec3> candidates(const std::vector<HalfPlane>& planes, double speed, const Vec3& wish) {
  std::vector<Vec3> out{wish};
  if (norm(wish) > 0) out.push_back(wish * (speed / norm(wish)));
  for (size_t i = 0; i < planes.size(); ++i) {
    const Vec3 n = planes[i].normal, t{-n.y, n.x, 0}, foot = n * planes[i].offset;
    out.push_back(foot + t * dot(wish, t));
    const double room = speed * speed - planes[i].offset * planes[i].offset;
    if (room >= 0) out.push_back(foot + t * std::sqrt(room)), out.push_back(foot - t * std::sqrt(room));
    for (size_t j = 0; j < i; ++j) {
      const double det = cross2(n, planes[j].normal);
      if (std::abs(det) > 1e-6) out.push_back(foot + t * (planes[j].lack(foot) / det));
    }
  }
  return out;
}

TEST(CrowdHalfPlanes, TheChosenVelocityIsTheClosestOfAllThatAreKept) {
  int feasible = 0;
  for (uint64_t seed = 0; seed < 2000; ++seed) {
    const auto planes = random_planes(seed, 1 + seed % 9, 1.5);
    const auto u = uniform4(seed, 2, 0);
    const Vec3 wish{4 * u[0] - 2, 4 * u[1] - 2, 0};
    double best = HUGE_VAL;
    for (const Vec3& v : candidates(planes, 1.5, wish)) {
      if (keeps(planes, 1.5, v, 1e-9)) best = std::min(best, norm(v - wish));
    }
    const Chosen c = choose_velocity(planes, 0, 1.5, wish);
    // Intersections of nearly parallel lines amplify rounding a thousandfold.
    if (c.fit == Fit::feasible) {
      ++feasible;
      EXPECT_TRUE(keeps(planes, 1.5, c.velocity, 1e-8)) << seed;
      EXPECT_NEAR(norm(c.velocity - wish), best, 1e-6) << seed;
    } else {
      EXPECT_EQ(best, HUGE_VAL) << seed;
    }
  }
  // Both cases must occur, or this would not test them.
  EXPECT_GT(feasible, 500);
  EXPECT_LT(feasible, 1900);
}

double largest_lack(const std::vector<HalfPlane>& planes, size_t from, const Vec3& v) {
  double worst = -HUGE_VAL;
  for (size_t k = from; k < planes.size(); ++k) worst = std::max(worst, planes[k].lack(v));
  return worst;
}

TEST(CrowdHalfPlanes, WhereNoneIsFeasibleTheLargestLackIsLeast) {
  int relaxed = 0;
  for (uint64_t seed = 0; seed < 400; ++seed) {
    auto planes = random_planes(seed, 8, 1.5);
    const size_t hard = seed % 3;
    for (size_t k = 0; k < hard; ++k)
      planes[k].offset = -0.3;  // the disc of 0.3 m/s about rest is free of walls
    const Chosen c = choose_velocity(planes, hard, 1.5, {0.3, 0.2, 0});
    if (c.fit == Fit::feasible) continue;
    ++relaxed;
    for (size_t k = 0; k < hard; ++k) EXPECT_LE(planes[k].lack(c.velocity), 1e-8);
    // A grid over the disc with a spacing of 3 mm/s: none of its points is better by more than the spacing.
    double best = HUGE_VAL;
    for (double x = -1.5; x <= 1.5; x += 0.003) {
      for (double y = -1.5; y <= 1.5; y += 0.003) {
        const Vec3 v{x, y, 0};
        if (norm(v) > 1.5) continue;
        bool kept = true;
        for (size_t k = 0; k < hard; ++k) kept = kept && planes[k].lack(v) <= 0;
        if (kept) best = std::min(best, largest_lack(planes, hard, v));
      }
    }
    EXPECT_LT(largest_lack(planes, hard, c.velocity), best + 1e-8) << seed;
    EXPECT_GT(largest_lack(planes, hard, c.velocity), best - 0.005) << seed;
  }
  EXPECT_GT(relaxed, 50);
}

/// Whether discs a distance p apart collide within the horizon at the relative velocity dv.
bool collide(const Vec3& p, const Vec3& dv, double reach, double horizon) {
  return norm(p - nearest_point({{}, dv * horizon}, p)) < reach;
}

TEST(CrowdOrca, TwoWhoEachTakeHalfOfTheWayOutDoNotCollide) {
  int met = 0, head_ons = 0;
  for (uint64_t k = 0; k < 3000; ++k) {
    const auto u = uniform4(5, 3, 2 * k), w = uniform4(5, 3, 2 * k + 1);
    const Vec3 p{4 * u[0] - 2, 4 * u[1] - 2, 0}, a{3 * u[2] - 1.5, 3 * u[3] - 1.5, 0},
        b{3 * w[0] - 1.5, 3 * w[1] - 1.5, 0};
    const double reach = 0.6, horizon = 2;
    if (norm(p) < reach) continue;
    const HalfPlane of_a = orca_plane(p, a, b, reach, horizon, 0.1, 0.5, {1, 0, 0}),
                    of_b = orca_plane(-p, b, a, reach, horizon, 0.1, 0.5, {-1, 0, 0});
    // The two ways out are opposite.
    EXPECT_LT(norm(of_a.normal + of_b.normal), 1e-12);
    const bool meet = collide(p, a - b, reach, horizon);
    met += meet;
    // On its boundary, either plane moves the relative velocity by u to the boundary of the colliding ones.
    const Vec3 va = a + of_a.normal * of_a.lack(a), vb = b + of_b.normal * of_b.lack(b);
    EXPECT_TRUE(!collide(p, va - vb, reach - 1e-9, horizon)) << k;
    // And no farther, except for agents that meet head-on and are led aside.
    const Vec3 from_cap = a - b - p / horizon;
    const bool head_on =
        std::abs(cross2(p, from_cap)) < kAside * norm(p) * norm(from_cap) && dot(p, from_cap) < 0;
    EXPECT_TRUE(head_on || collide(p, va - vb, reach + 1e-6, horizon)) << k;
    head_ons += head_on;
    // Control: if two would collide, the evasion of one alone is not enough.
    EXPECT_EQ(collide(p, a - vb, reach - 1e-9, horizon), meet) << k;
    EXPECT_EQ(of_a.lack(a) > 0, meet) << k;
  }
  EXPECT_GT(met, 300);
  EXPECT_LT(head_ons, 200);
}

TEST(CrowdOrca, CoincidentAndWithoutSize) {
  const HalfPlane a = orca_plane({}, {}, {}, 0.6, 2, 0.1, 0.5, {1, 0, 0}),
                  b = orca_plane({}, {}, {}, 0.6, 2, 0.1, 0.5, {-1, 0, 0});
  EXPECT_EQ(a.normal, (Vec3{1, 0, 0}));
  EXPECT_EQ(b.normal, (Vec3{-1, 0, 0}));
  EXPECT_DOUBLE_EQ(a.offset, 3);  // half of 0.6 m in 0.1 s
  const HalfPlane points = orca_plane({}, {}, {}, 0, 2, 0.1, 0.5, {1, 0, 0});
  EXPECT_EQ(points.offset, 0);
}

TEST(CrowdSocialForce, IsThePapersFormula) {
  const SocialLaw law;
  const Vec3 n{0.6, 0.8, 0}, dv{0.3, -0.5, 0}, t{-0.8, 0.6, 0};
  // Apart by 0.2 m: repulsion alone, 2000 exp(-0.2 / 0.08) N.
  const SocialForce far = social_force(law, n, 0.8, 0.6, dv);
  EXPECT_NEAR(norm(far.social), 2000 * std::exp(-2.5), 1e-11);
  EXPECT_EQ(far.contact, Vec3{});
  // Compressed by 0.05 m: in addition k 0.05 along n and kappa 0.05 (dv . t) along t.
  const SocialForce near = social_force(law, n, 0.55, 0.6, dv);
  const Vec3 expected = n * (2000 * std::exp(0.05 / 0.08) + 1.2e5 * 0.05) + t * (2.4e5 * 0.05 * dot(dv, t));
  EXPECT_LT(norm(near.social + near.contact - expected), 1e-9 * norm(expected));
  EXPECT_NEAR(near.radial, 2000 * std::exp(0.625) + 6000, 1e-8);
  // Control: without friction the force differs by far more than the tolerance.
  SocialLaw smooth;
  smooth.friction = 0;
  EXPECT_GT(norm(social_force(smooth, n, 0.55, 0.6, dv).contact - near.contact), 1000);
}

TEST(CrowdSocialForce, WhoIsBehindCountsLess) {
  EXPECT_EQ(attention(0.2, {1, 0, 0}, {-1, 0, 0}), 1);   // pushed from ahead
  EXPECT_EQ(attention(0.2, {1, 0, 0}, {1, 0, 0}), 0.2);  // from behind
  EXPECT_EQ(attention(1, {1, 0, 0}, {0.6, 0.8, 0}), 1);
}

TEST(CrowdSegment, CrossingsHaveASide) {
  const Segment door{{0, 0, 0}, {2, 0, 0}};
  EXPECT_EQ(crossing({{1, -1, 0}, {1, 1, 0}}, door), 1);
  EXPECT_EQ(crossing({{1, 1, 0}, {1, -1, 0}}, door), -1);
  EXPECT_EQ(crossing({{3, -1, 0}, {3, 1, 0}}, door), 0);
  EXPECT_EQ(crossing({{1, 1, 0}, {1, 2, 0}}, door), 0);
  // For a wall: nobody ends on it, and whoever starts on it may leave.
  EXPECT_TRUE(runs_into({{1, -1, 0}, {1, 0, 0}}, door));
  EXPECT_TRUE(runs_into({{1, 1, 0}, {1, -1, 0}}, door));
  EXPECT_FALSE(runs_into({{1, 0, 0}, {1, 1, 0}}, door));
  EXPECT_FALSE(runs_into({{1, 0, 0}, {1, -1, 0}}, door));
  EXPECT_FALSE(runs_into({{3, 1, 0}, {3, -1, 0}}, door));
  EXPECT_EQ(segment_distance({{1, -1, 0}, {1, 1, 0}}, door), 0);
  EXPECT_EQ(segment_distance({{3, -1, 0}, {3, 1, 0}}, door), 1);
}

}  // namespace
}  // namespace truestep::crowd
