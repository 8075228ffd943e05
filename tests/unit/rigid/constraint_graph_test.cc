// Colours, islands and soft constraints: the common parts of rigid body solvers.
#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <vector>

#include "engine/base/random.h"
#include "engine/kernels/rigid/soft_constraint.h"
#include "engine/rigid/constraint_colouring.h"
#include "engine/rigid/islands.h"

namespace truestep {
namespace {

std::vector<ConstraintEnds> random_links(size_t count, uint32_t bodies) {
  std::vector<ConstraintEnds> ends;
  for (size_t i = 0; i < count; ++i) {
    const auto u = uniform4(7, 1, i);
    const auto a = static_cast<uint32_t>(u[0] * bodies), b = static_cast<uint32_t>(u[1] * bodies);
    if (a != b) ends.push_back({u[2] < 0.1 ? kNoBody : a, b});
  }
  return ends;
}

TEST(ConstraintColouring, NoColourHoldsABodyTwice) {
  const auto ends = random_links(5000, 400);
  std::vector<uint64_t> used(400);
  std::vector<uint8_t> colour(ends.size());
  std::array<uint32_t, kColours + 1> count;
  colour_constraints(ends, used, colour, count);
  std::set<std::pair<uint32_t, uint32_t>> seen;
  for (size_t i = 0; i < ends.size(); ++i) {
    for (const uint32_t body : ends[i]) {
      if (body != kNoBody && colour[i] < kColours) {
        EXPECT_TRUE(seen.insert({colour[i], body}).second);
      }
    }
  }
  std::vector<uint32_t> order(ends.size());
  sort_by_colour(colour, count, order);
  for (size_t k = 1; k < order.size(); ++k) {
    EXPECT_LE(colour[order[k - 1]], colour[order[k]]);
    if (colour[order[k - 1]] == colour[order[k]]) {
      EXPECT_LT(order[k - 1], order[k]);
    }
  }
}

TEST(ConstraintColouring, ABodyOfManyConstraintsLeavesSomeOver) {
  std::vector<ConstraintEnds> ends;
  for (uint32_t i = 1; i <= 100; ++i) ends.push_back({0, i});
  std::vector<uint64_t> used(101);
  std::vector<uint8_t> colour(ends.size());
  std::array<uint32_t, kColours + 1> count;
  colour_constraints(ends, used, colour, count);
  EXPECT_EQ(count[kColours], 100 - kColours);
  for (uint32_t c = 0; c < kColours; ++c) EXPECT_EQ(count[c], 1u);
}

TEST(Islands, TheSmallestBodyNamesAnIslandInAnyOrder) {
  auto ends = random_links(150, 300);
  std::vector<uint32_t> up(300), down(300);
  start_islands(up), start_islands(down);
  for (size_t i = 0; i < ends.size(); ++i) {
    const auto &e = ends[i], &f = ends[ends.size() - 1 - i];
    if (e[0] != kNoBody) link_islands(up, e[0], e[1]);
    if (f[0] != kNoBody) link_islands(down, f[1], f[0]);
  }
  std::vector<double> least(300);
  for (uint32_t i = 0; i < 300; ++i) {
    EXPECT_EQ(island_of(up, i), island_of(down, i));
    EXPECT_LE(island_of(up, i), i);
    least[i] = (i * 37) % 300;
  }
  spread_minimum<double>(up, least);
  for (uint32_t i = 0; i < 300; ++i) {
    double expected = 300;
    for (uint32_t k = 0; k < 300; ++k) {
      if (island_of(up, k) == island_of(up, i)) expected = std::min<double>(expected, (k * 37) % 300);
    }
    EXPECT_EQ(least[i], expected);
  }
}

TEST(SoftConstraint, IsImplicitEulerOfADampedSpring) {
  // One mass m on a spring k = m w^2, c = 2 m z w:  v1 = (v - h w^2 x) / (1 + 2 z h w + h^2 w^2).
  const double h = 1.0 / 240, hertz = 30, z = 0.7, w = 2 * std::numbers::pi * hertz, x = 0.02, v = -0.3;
  const auto s = soft_constraint(hertz, z, h);
  const double v1 = v - s.mass_scale * (v + s.bias_rate * x);
  EXPECT_NEAR(v1, (v - h * w * w * x) / (1 + 2 * z * h * w + h * h * w * w), 1e-14);
  // A rigid constraint recovers its share whatever the load.
  const auto r = rigid_constraint(0.2, h);
  EXPECT_NEAR(v - (v + r.bias_rate * x), -0.2 * x / h, 1e-14);
}

}  // namespace
}  // namespace truestep
