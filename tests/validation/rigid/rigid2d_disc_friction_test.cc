// Friction of discs in the plane against closed forms: a disc's rim stays in place while the disc rotates.
#include <gtest/gtest.h>

#include "tests/support/rigid2d_run.h"

namespace truestep::testing {
namespace {

constexpr double kG = 9.81, kMu = 0.5, kRadius = 0.5;

struct Case {
  const char* precision = "f32";
  double dt = 1.0 / 60;
  int substeps = 4;
  const char* shape = R"({"type": "circle", "radius": 0.5})";
};

FlatTrial disc(const Case& c, double speed, double spin) {
  return FlatTrial(std::string(R"("precision": ")") + c.precision +
                       R"(", "sleeping": false, "gravity": [0, -9.81, 0], "substeps": )" +
                       std::to_string(c.substeps) +
                       R"(, "bodies": [{"motion": "fixed", "friction": 0.5, "shapes":
      [{"type": "box", "half_extents": [500, 1, 0], "center": [0, -1, 0]}]},
    {"position": [0, 0.5, 0], "friction": 0.5, "velocity": [)" +
                       FlatTrial::number(speed) + R"(, 0, 0], "angular_velocity": )" +
                       FlatTrial::number(spin) + R"(, "shapes": [)" + c.shape + "]}]",
                   c.dt);
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const char* precision : {"f32", "f64"}) {
    for (const double dt : {1.0 / 60, 1e-3}) {
      for (const int steps : {1, 2, 4, 8}) all.push_back({precision, dt, steps});
    }
  }
  return all;
}

std::string said(const Case& c) {
  return std::string(c.precision) + " dt " + std::to_string(c.dt) + " steps " + std::to_string(c.substeps);
}

TEST(Rigid2dDisc, SpunInPlaceFeelsFrictionOfMuN) {
  for (const Case& c : cases()) {
    for (const double spin : {10.0, 100.0, -100.0}) {
      FlatTrial t = disc(c, 0, spin);
      // It slips until mu g t = (r spin - 2 mu g t), at 10 rad/s for 0.34 s.
      const int steps = static_cast<int>(0.3 / c.dt + 0.5);
      double sunk = 0;
      for (int k = 0; k < steps; ++k) t.steps(1), sunk = std::max(sunk, std::abs(t.position(1).y - kRadius));
      const double direction = spin > 0 ? -1 : 1, time = steps * c.dt;
      // In the first substep there is no normal force yet when friction is solved.
      const double late = 0.5 * c.dt / c.substeps / time;
      EXPECT_NEAR(direction * t.velocity(1).x / (kMu * kG * time), 1, 2e-3 + late) << said(c) << " " << spin;
      EXPECT_LT(sunk, c.substeps > 1 ? 1e-3 : 5e-3) << said(c) << " " << spin;
    }
  }
}

TEST(Rigid2dDisc, SlidingTurnsToRollingWhereItShould) {
  constexpr double kSpeed = 10, kRolls = kSpeed / (3 * kMu * kG);
  for (const Case& c : cases()) {
    FlatTrial t = disc(c, kSpeed, 0);
    double rolls = 0;
    const int steps = static_cast<int>(1 / c.dt + 0.5);
    for (int k = 0; k < steps; ++k) {
      t.steps(1);
      if (rolls == 0 && t.velocity(1).x + kRadius * t.spin(1) < 1e-3) rolls = (k + 1) * c.dt;
    }
    EXPECT_NEAR(t.velocity(1).x / kSpeed, 2.0 / 3, 2e-3) << said(c);
    EXPECT_NEAR(rolls, kRolls, c.dt + 2e-3 * kRolls) << said(c);
    // x = v0 t - mu g t^2 / 2 while it slides.
    const double x = kSpeed * kRolls - 0.5 * kMu * kG * kRolls * kRolls + 2.0 / 3 * kSpeed * (1 - kRolls);
    // Friction that begins half a substep late leaves a third of mu g h.
    EXPECT_NEAR(t.position(1).x, x, 3e-3 + kMu * kG * c.dt / c.substeps / 3) << said(c);
  }
}

/// Rounded boxes and capsules turn about their corners as discs do: they rest on an edge and a corner. The
/// control: without its rounding the tip of a capsule would dip by r (1 - cos(w dt)).
TEST(Rigid2dDisc, ASpinningCapsuleStaysOutOfTheFloor) {
  Case c;
  c.shape = R"({"type": "capsule", "from": [-0.001, 0, 0], "to": [0.001, 0, 0], "radius": 0.5})";
  FlatTrial t = disc(c, 0, 100);
  double off = 0;
  for (int k = 0; k < 30; ++k) t.steps(1), off = std::max(off, std::abs(t.position(1).y - kRadius));
  EXPECT_LT(off, 5e-3);
  EXPECT_NEAR(-t.velocity(1).x / (kMu * kG * 0.5), 1, 0.1);
}

}  // namespace
}  // namespace truestep::testing
