// Liquids of particles in pictures: balls or, if the scene says so, their surface.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/pictures/picture_session.h"

namespace truestep {
namespace {

std::string water(const std::string& liquid, const std::string& system) {
  return R"({"schema_version": "1.0", "name": "w", "time": {"dt": 0.01, "duration": 1}, "viewer": {"color_by": "speed", "liquid": ")" +
         liquid + R"("}, "systems": [{"id": "w", )" + system + "}]}";
}
constexpr const char* kSph =
    R"("type": "sph", "high": [0.6, 0.6, 0.6], "spacing": 0.05, "bodies": [{"center": [0.3, 0.2, 0.3], "half_extents": [0.2, 0.2, 0.2]}])";
constexpr const char* kFlip =
    R"("type": "grid_fluid", "cells": [8, 8, 8], "size": [0.8, 0.8, 0.8], "advection": "flip", "side": {"kind": "slip"},
       "bodies": [{"center": [0.4, 0.2, 0.4], "half_extents": [0.2, 0.2, 0.2]}])";
constexpr const char* kPlane =
    R"("type": "sph", "dimension": 2, "high": [0.6, 0.6, 0.6], "spacing": 0.05, "bodies": [{"center": [0.3, 0.2, 0], "half_extents": [0.2, 0.2, 0.2]}])";

DrawPoints drawn(const std::string& liquid, const std::string& system) {
  const DrawList list = test::PictureSession(water(liquid, system), 2).list();
  EXPECT_EQ(list.points.size(), 1u);
  return list.points.at(0);
}

TEST(LiquidPicture, IsASurfaceWhereTheSceneSaysSo) {
  for (const char* system : {kSph, kFlip}) {
    const DrawPoints s = drawn("surface", system);
    EXPECT_EQ(s.radius, 0);
    EXPECT_GT(s.triangles.size(), 1000u);
    EXPECT_EQ(s.scalar.size() * 3, s.positions.size());
    // It surrounds the cube of 0.4 m, at most half a spacing beyond the particles' volume.
    for (size_t i = 1; i < s.positions.size(); i += 3) {
      EXPECT_GT(s.positions[i], -0.05f);
      EXPECT_LT(s.positions[i], 0.45f);
    }
    const DrawPoints balls = drawn("balls", system);
    EXPECT_GT(balls.radius, 0) << "control";
    EXPECT_TRUE(balls.triangles.empty());
    // Colours have the same meaning.
    const auto most = std::max_element(balls.scalar.begin(), balls.scalar.end());
    EXPECT_FLOAT_EQ(s.scalar_max.value(), *most);
  }
  EXPECT_TRUE(drawn("surface", kPlane).triangles.empty()) << "a plane liquid has none";
}

}  // namespace
}  // namespace truestep
