// Springs of joints are part of the energy of rigid bodies: an isolated pair exchanges kinetic energy for
// spring energy and back, and energy.total is conserved.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/session/session.h"

namespace truestep {
namespace {

struct Swing {
  double first = 0, most_off = 0, kinetic_swing = 0;
};

/// The largest change of energy.total in 10 s, and the range of energy.kinetic.
Swing swing(const std::string& system) {
  const auto arena = std::make_shared<const ThreadArena>(1);
  Session s(std::make_shared<const World>(parse_scene(
                R"({"schema_version": "1.0", "gravity": [0, 0, 0], "time": {"dt": 0.005, "duration": 10},
                    "systems": [)" +
                system + "]}")),
            arena, {.history_bytes = 0});
  Swing out;
  out.first = s.observe().find("energy.total").value();
  double least = HUGE_VAL, most = 0;
  for (int k = 0; k < 2000; ++k) {
    EXPECT_TRUE(s.step(1)) << (s.failure() ? s.failure()->detail : "");
    const Observables seen = s.observe();
    out.most_off = std::max(out.most_off, std::abs(seen.find("energy.total").value() - out.first));
    least = std::min(least, seen.find("energy.kinetic").value());
    most = std::max(most, seen.find("energy.kinetic").value());
  }
  out.kinetic_swing = most - least;
  return out;
}

/// The initial motion of the bodies, as the joint allows: it stops any other in the first step.
enum class Start { parting, twisting };

std::string in_space(const std::string& joint, Start start, const std::string& precision) {
  return R"({"type": "rigid3d", "id": "s", "sleeping": false, "precision": ")" + precision +
         R"(", "bodies": [
      {"type": "box", "half_extents": [0.4, 0.2, 0.3], "mass": 1, "mask": 0, )" +
         (start == Start::parting ? R"("velocity": [0.7, 0, 0])" : R"("angular_velocity": [1.5, 0, 0])") +
         R"(},
      {"type": "box", "half_extents": [0.3, 0.2, 0.2], "position": [1, 0, 0], "mass": 2, "mask": 0}],
      "joints": [{"a": 0, "b": 1, )" +
         joint + "}]}";
}
std::string in_plane(const std::string& joint, Start start, const std::string& precision) {
  const bool parting = start == Start::parting;
  return R"({"type": "rigid2d", "id": "s", "sleeping": false, "precision": ")" + precision +
         R"(", "bodies": [
      {"mass": 1, "mask": 0, )" +
         (parting ? R"("velocity": [0.7, 0, 0],)" : R"("angular_velocity": 1.5,)") + R"(
       "shapes": [{"type": "box", "half_extents": [0.4, 0.2, 0]}]},
      {"mass": 2, "mask": 0, "position": [1, 0, 0],)" +
         (parting ? "" : R"("angular_velocity": -1.5,)") + R"(
       "shapes": [{"type": "box", "half_extents": [0.3, 0.2, 0]}]}],
      "joints": [{"a": 0, "b": 1, )" +
         joint + "}]}";
}

void keeps(const std::string& system, const std::string& what) {
  const Swing s = swing(system);
  EXPECT_GT(s.kinetic_swing, 0.02 * s.first)
      << what << ": control: without its springs the energy would swing";
  // Springs between two points alone act at a step's ends, to second order; next to rigid rows they act in
  // the solver's substeps, to first order.
  EXPECT_LT(s.most_off, 0.1 * s.kinetic_swing) << what << ", of " << s.first << " J";
}

TEST(SpringsOfJointsCount, InSpace) {
  for (const char* precision : {"f32", "f64"}) {
    for (const auto& [start, joint] :
         {std::pair{Start::parting, R"("type": "spring", "stiffness": 20, "damping": 0, "length": 0.8)"},
          {Start::parting, R"("type": "spring", "hertz": 1, "damping_ratio": 0)"},
          {Start::parting,
           R"("type": "slider", "axis": [1, 0, 0], "stiffness": 20, "damping": 0, "rest": 0.3)"},
          {Start::twisting, R"("type": "hinge", "axis": [1, 0, 0], "hertz": 1, "damping_ratio": 0)"},
          {Start::twisting,
           R"("type": "hinge", "axis": [1, 0, 0], "stiffness": 1, "damping": 0, "rest": 4)"}})
      keeps(in_space(joint, start, precision), joint);
  }
}

TEST(SpringsOfJointsCount, InThePlane) {
  const std::string ends = R"("type": "distance", "anchor": [0, 0, 0], "anchor_b": [1, 0, 0], )";
  for (const char* precision : {"f32", "f64"}) {
    for (const auto& [start, joint] :
         {std::pair{Start::parting, ends + R"("hertz": 1, "damping_ratio": 0)"},
          {Start::parting, ends + R"("length": 0.7, "hertz": 1, "damping_ratio": 0)"},
          {Start::parting, R"("type": "prismatic", "axis": [1, 0, 0], "hertz": 1, "damping_ratio": 0)"},
          {Start::twisting, R"("type": "revolute", "anchor": [0.5, 0, 0], "hertz": 1, "damping_ratio": 0)"},
          {Start::twisting, R"("type": "weld", "anchor": [0.5, 0, 0], "hertz": 1, "damping_ratio": 0)"}})
      keeps(in_plane(joint, start, precision), joint);
  }
}

// A spring that is stretched at the start supplies all the energy.
TEST(SpringsOfJointsCount, WhatTheyHoldAtTheStart) {
  const std::string apart = R"({"type": "rigid3d", "id": "s", "bodies": [
      {"type": "sphere", "radius": 0.1, "mass": 1}, {"type": "sphere", "radius": 0.1, "mass": 1, "position": [1, 0, 0]}],
      "joints": [{"type": "spring", "a": 0, "b": 1, "stiffness": 50, "damping": 0, "length": 0.6}]})";
  EXPECT_NEAR(swing(apart).first, 0.5 * 50 * 0.4 * 0.4, 1e-9);
}

}  // namespace
}  // namespace truestep
