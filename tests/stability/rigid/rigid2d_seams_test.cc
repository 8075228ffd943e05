// Ground made of many boxes side by side is one surface: what slides or rolls over their seams does not
// catch. Boxes that slid at 10 m/s were stopped at a seam, and slower ones tripped over it.
#include <gtest/gtest.h>

#include "tests/support/rigid2d_run.h"

namespace truestep::testing {
namespace {

constexpr const char* kSeamShapes[] = {
    R"({"type": "box", "half_extents": [0.25, 0.25, 0]})", R"({"type": "circle", "radius": 0.25})",
    R"({"type": "capsule", "from": [-0.3, 0, 0], "to": [0.3, 0, 0], "radius": 0.25})"};

struct Slab {
  double x, top, half_width = 0.5, half_height = 0.5;
};

std::string slabs(const std::vector<Slab>& all) {
  std::string out;
  for (const Slab& s : all) {
    out += R"({"motion": "fixed", "position": [)" + FlatTrial::number(s.x) + ", " +
           FlatTrial::number(s.top - s.half_height) +
           R"(, 0], "friction": 0, "shapes": [{"type": "box", "half_extents": [)" +
           FlatTrial::number(s.half_width) + ", " + FlatTrial::number(s.half_height) + R"(, 0]}]}, )";
  }
  return out;
}

std::vector<Slab> floor_of(int n) {
  std::vector<Slab> all;
  for (int i = 0; i < n; ++i) {
    all.push_back({-12.0 + i, 0});
    // Alternately deep and thin.
    all.back().half_height = i % 2 ? 0.5 : 0.1;
  }
  return all;
}

FlatTrial slider(const std::vector<Slab>& ground, const char* shape, double speed, const char* turns = "") {
  return FlatTrial(R"("sleeping": false, "bodies": [)" + slabs(ground) +
                   R"({"position": [-10, 0.25, 0], "velocity": [)" + FlatTrial::number(speed) +
                   R"(, 0, 0], "friction": 0)" + turns + R"(, "shapes": [)" + shape + "]}]");
}

TEST(Rigid2dSeams, NothingCatchesOnAFloorOfBoxes) {
  const auto ground = floor_of(100);
  for (const char* shape : kSeamShapes) {
    for (const double speed : {0.3, 1.0, 3.0, 10.0, 25.0}) {
      FlatTrial t = slider(ground, shape, speed);
      for (int k = 0; k < 10; ++k) {
        t.steps(18);
        EXPECT_NEAR(t.position(ground.size()).y, 0.25, 1e-3) << shape << " " << speed;
      }
      // Without friction nothing slows it down or turns it, but that a capsule whose load two slabs share
      // tilts by up to 1e-4 rad: in a second that is worth 1e-3 m/s.
      EXPECT_NEAR(t.velocity(ground.size()).x, speed, 1e-3) << shape;
      EXPECT_NEAR(t.spin(ground.size()), 0, 1e-3) << shape << " " << speed;
    }
  }
}

TEST(Rigid2dSeams, AStepAndAWallStillStop) {
  for (const double height : {0.02, 0.1, 1.0}) {
    for (const double speed : {1.0, 10.0, 25.0}) {
      auto ground = floor_of(40);
      ground.push_back({5.5, height});
      // What cannot trip over it does not go on.
      FlatTrial t = slider(ground, kSeamShapes[0], speed, R"(, "fixed_rotation": true)");
      t.steps(static_cast<int>(60 * 20 / speed));
      EXPECT_LT(t.position(ground.size()).x, 4.76) << height << " " << speed;
    }
  }
}

TEST(Rigid2dSeams, WhatStandsInACornerLeansOnBothSides) {
  // A box on its corner, between floor and wall that begin at the same seam: a corner of its own is at it.
  std::vector<Slab> ground = floor_of(40);
  ground.push_back({5.5, 2, 0.5, 1});
  const size_t box = ground.size();
  FlatTrial t(R"("sleeping": false, "bodies": [)" + slabs(ground) +
              R"({"position": [4.64, 0.3536, 0], "angle": 0.7854, "velocity": [3, 0, 0], "friction": 0,
                  "shapes": [{"type": "box", "half_extents": [0.25, 0.25, 0]}]}])");
  for (int k = 0; k < 60; ++k) {
    t.steps(1);
    EXPECT_LT(t.observed("penetration"), 0.01) << k;
  }
  EXPECT_LT(t.position(box).x, 5);
}

}  // namespace
}  // namespace truestep::testing
