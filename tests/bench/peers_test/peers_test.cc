// Every engine of the comparisons, peers and ours alike, interprets a scene in the same way. Peers built from
// crates are searched where `truestep bench` builds them; a clone that never ran it tests the others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/bench/rigid2d/assumptions.h"
#include "tests/bench/rigid3d/assumptions.h"

namespace truestep::bench {
namespace {

std::string library(const char* crate) {
  return std::string(TRUESTEP_BENCH_FOLDER) + '/' + crate + "/release/lib" + crate + "_peer.so";
}

void expect_all(const std::vector<Assumption>& all) {
  EXPECT_FALSE(all.empty());
  for (const Assumption& a : all)
    EXPECT_TRUE(a.holds()) << a.what << ": " << a.measured << " instead of " << a.expected;
}

TEST(BenchPeers, OursInSpace) {
  expect_all(
      space_assumptions([](const SpaceScene& s, Sleep sleep) { return make_ours(s, {.sleep = sleep}); }));
}
TEST(BenchPeers, BulletInSpace) {
  if (!make_bullet(space_stack(1, 0))) GTEST_SKIP() << "Bullet is not installed";
  expect_all(space_assumptions([](const SpaceScene& s, Sleep sleep) { return make_bullet(s, sleep); }));
}
TEST(BenchPeers, RapierInSpace) {
  const auto rapier = RapierLibrary::open(library("rapier3d").c_str());
  if (!rapier) GTEST_SKIP() << "its crate is not built";
  expect_all(space_assumptions([&](const SpaceScene& s, Sleep sleep) { return rapier->make(s, sleep); }));
}

TEST(BenchPeers, OursInThePlane) {
  expect_all(flat_assumptions([](const FlatScene& s, Sleep sleep) { return make_ours(s, sleep); }));
}
TEST(BenchPeers, Box2d24InThePlane) {
  if (!make_box2d(flat_stack(1))) GTEST_SKIP() << "Box2D 2.4 is not installed";
  expect_all(flat_assumptions([](const FlatScene& s, Sleep sleep) { return make_box2d(s, sleep); }));
}
void from_crate(const char* crate) {
  FlatLibrary peer;
  if (!peer.open(library(crate).c_str())) GTEST_SKIP() << "its crate is not built";
  expect_all(flat_assumptions([&](const FlatScene& s, Sleep sleep) { return peer.make(s, sleep); }));
}
TEST(BenchPeers, Rapier2dInThePlane) {
  from_crate("rapier2d");
}
TEST(BenchPeers, Box2d3InThePlane) {
  from_crate("box2d3");
}

// The control: a capsule along z would stand.
TEST(BenchPeers, ACapsuleAlongAnotherAxisIsFound) {
  const auto along_z = [](SpaceScene s, Sleep sleep) {
    for (SpaceBody& b : s.bodies) {
      if (b.shape == SpaceBody::Shape::capsule)
        b.pose.orientation = b.pose.orientation * Quat{std::sqrt(0.5), std::sqrt(0.5), 0, 0};
    }
    return make_ours(s, {.sleep = sleep});
  };
  const auto all = space_assumptions(along_z);
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const Assumption& a) { return !a.holds(); }));
}

}  // namespace
}  // namespace truestep::bench
