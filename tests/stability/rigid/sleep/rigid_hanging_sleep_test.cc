// What touches nothing and hangs on joints or springs sleeps in balance, not at a slow place of its swing.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/world_run.h"

namespace truestep::testing {
namespace {

constexpr double kTwoPi = 6.283185307179586;

/// A scene of one system "r" of either kind.
struct Hanging : testing_rig::WorldRun {
  Hanging(const std::string& kind, const std::string& members)
      : WorldRun(R"({"time": {"dt": )" + std::to_string(1.0 / 60) + R"(}, "systems": [{"type": ")" + kind +
                 R"(", "id": "r", )" + members + "}]}") {}
  double awake() const { return observed("awake"); }
};

const std::string kKinds[] = {"rigid2d", "rigid3d"};

std::string ball_at(const std::string& kind, double x, double y, const std::string& more = "") {
  const std::string at =
      "\"position\": [" + std::to_string(x) + ", " + std::to_string(y) + ", 0], \"mass\": 1" + more;
  return kind == "rigid2d" ? "{" + at + R"(, "shapes": [{"type": "circle", "radius": 0.2}]})"
                           : R"({"type": "sphere", "radius": 0.2, )" + at + "}";
}

/// A ball of 1 kg without gravity on an undamped spring to the world.
Hanging on_a_spring(const std::string& kind, double hertz, double amplitude, double damping = 0) {
  const double w = kTwoPi * hertz;
  return {kind,
          R"("gravity": [0, 0, 0], "bodies": [)" + ball_at(kind, 1 + amplitude, 0) +
              R"(], "joints": [{"type": "spring", "a": -1, "b": 0, "anchor": [0, 0, 0], "anchor_b": [)" +
              std::to_string(1 + amplitude) + R"(, 0, 0], "length": 1, "stiffness": )" +
              std::to_string(w * w) + R"(, "damping": )" + std::to_string(damping) + "}]"};
}

/// The control: what has come into balance sleeps.
TEST(RigidHangingSleep, WhatHangsInBalanceSleeps) {
  for (const std::string& kind : kKinds) {
    // At critical damping 2 cm of an oscillation of 1 Hz are below a micrometre after 2 s.
    Hanging spring = on_a_spring(kind, 1, 0.02, 2 * kTwoPi);
    spring.steps(300);
    EXPECT_EQ(spring.awake(), 0) << kind;
    // A chain of ten balls, damped.
    std::string bodies, joints;
    for (int k = 0; k < 10; ++k) {
      bodies += std::string(k ? "," : "") + ball_at(kind, 0.5 * k, 0, R"(, "linear_damping": 2)");
      joints += std::string(k ? "," : "") + R"({"type": "spherical", "a": )" + std::to_string(k - 1) +
                R"(, "b": )" + std::to_string(k) + R"(, "anchor": [)" + std::to_string(0.5 * k - 0.25) +
                ", 0, 0]}";
    }
    if (kind == "rigid2d") {
      for (size_t at; (at = joints.find("spherical")) != std::string::npos;)
        joints.replace(at, 9, "revolute");
    }
    Hanging chain(kind,
                  R"("gravity": [0, -9.81, 0], "bodies": [)" + bodies + R"(], "joints": [)" + joints + "]");
    int slept = 0;
    for (int k = 1; k <= 3600 && slept == 0; ++k) {
      chain.steps(1);
      if (chain.awake() == 0) slept = k;
    }
    std::printf("%s: the chain sleeps after %.1f s\n", kind.c_str(), slept / 60.0);
    EXPECT_GT(slept, 0) << kind;
  }
}

}  // namespace
}  // namespace truestep::testing
