// Implicit Euler and its linearised form on heat and waves: on one mode of a lattice a step is a division,
// known exactly, whatever solves the equations; order 1 in time; both methods do the same where equations are
// linear.
#include <gtest/gtest.h>

#include <complex>
#include <cstdio>
#include <numbers>

#include "engine/base/errors.h"
#include "tests/support/fluids/field_run.h"

namespace truestep::test {
namespace {

using heat::HeatDef;
using lattice::SideKind;
using wave::WaveDef;
constexpr const char* kEuler[] = {"implicit_euler", "linear_implicit_euler"};

/// 1/m^2: the lattice's -u_xx of sin(pi x) in this many cells of [0, 1].
double second_difference(int cells) {
  const double s = std::sin(0.5 * std::numbers::pi / cells);
  return 4.0 * cells * cells * s * s;
}
double mode_at(double x, double y, double) {
  return std::sin(std::numbers::pi * x) * std::cos(std::numbers::pi * y);
}

constexpr int kCells = 12;
/// One mode in the plane, held along x and insulated along y. As an expression the coefficient is solved by
/// multigrid, as a number by transforms.
template <class Def>
Def plane(const char* method) {
  Def d;
  d.cells = {kCells, kCells};
  d.initial = "sin(pi*x)*cos(pi*y)";
  d.all = side(SideKind::dirichlet);
  d.sides.y_min = d.sides.y_max = side(SideKind::neumann);
  d.integrator = method;
  return d;
}
HeatDef plate(const char* method, const char* diffusivity = "0.5") {
  HeatDef d = plane<HeatDef>(method);
  d.diffusivity = diffusivity;
  return d;
}
WaveDef drum(const char* method, const char* speed = "2") {
  WaveDef d = plane<WaveDef>(method);
  d.speed = speed;
  return d;
}
const double kDecay = 0.5 * 2 * second_difference(kCells);           // 1/s
const double kOmega = 2 * std::sqrt(2 * second_difference(kCells));  // 1/s

/// Amplitude of x'' = -omega^2 x after n steps of implicit Euler from 1 at rest: (x, v) = (1 - h L)^-n.
double turned(double omega, double h, uint64_t n) {
  std::complex<double> z = 1;
  for (uint64_t k = 0; k < n; ++k) z /= std::complex<double>(1, -h * omega);
  return z.real();
}

TEST(FieldEuler, AStepDividesAModeOfHeat) {
  constexpr double kStep = 0.05;  // s; fourteen times what explicit Euler holds
  constexpr uint64_t kSteps = 8;
  for (const char* method : kEuler) {
    for (const char* diffusivity : {"0.5", "0.5 + 0*x"}) {
      FieldRun run(plate(method, diffusivity), kStep);
      run.steps(kSteps);
      const double amplitude = std::pow(1 + kStep * kDecay, -double(kSteps));
      // The initial values are rounded, and the iteration ends at a change of 1e-12 of the largest.
      EXPECT_LT(run.error([&](double x, double y, double z) { return amplitude * mode_at(x, y, z); }), 1e-10)
          << method << ' ' << diffusivity;
      // Control: the exact decay is another one.
      const double exact = std::exp(-kDecay * kStep * double(kSteps));
      EXPECT_GT(std::abs(amplitude - exact), 1e-3);
    }
  }
}

TEST(FieldEuler, AStepDividesAModeOfAWave) {
  constexpr double kStep = 0.1;  // s, 0.9 rad of the mode
  constexpr uint64_t kSteps = 5;
  for (const char* method : kEuler) {
    for (const char* speed : {"2", "2 + 0*x"}) {
      FieldRun run(drum(method, speed), kStep);
      run.steps(kSteps);
      const double amplitude = turned(kOmega, kStep, kSteps);
      EXPECT_LT(run.error([&](double x, double y, double z) { return amplitude * mode_at(x, y, z); }), 1e-10)
          << method << ' ' << speed;
      EXPECT_GT(std::abs(amplitude - std::cos(kOmega * kStep * double(kSteps))), 1e-2);  // control
    }
  }
}

TEST(FieldEuler, IsOfFirstOrderInTime) {
  const auto error = [](auto def, double end, double exact, uint64_t n) {
    FieldRun run(def, end / double(n));
    run.steps(n);
    return run.error([&](double x, double y, double z) { return exact * mode_at(x, y, z); });
  };
  // The next term of the error is smaller by h lambda / 2, which is 1/50 and less.
  constexpr double kEnd = 0.1;
  for (const char* method : {"implicit_euler", "linear_implicit_euler", "trapezoid"}) {
    const double promised = method[0] == 't' ? 2 : 1;  // the control
    const double decayed = std::exp(-kDecay * kEnd), phase = std::cos(kOmega * kEnd);
    const double heat = std::log2(error(plate(method), kEnd, decayed, 64) /
                                  error(plate(method), kEnd, decayed, 128)),
                 wave =
                     std::log2(error(drum(method), kEnd, phase, 256) / error(drum(method), kEnd, phase, 512));
    std::printf("%-22s order in time %.3f (heat) %.3f (wave)\n", method, heat, wave);
    EXPECT_NEAR(heat, promised, 0.1) << method;
    EXPECT_NEAR(wave, promised, 0.1) << method;
  }
}

TEST(FieldEuler, BothDoTheSameToLinearEquations) {
  // With sources and sides that move in time; the coefficient too.
  const auto plates = [](const char* method) {
    HeatDef d = plate(method, "0.5 + x*y + 0.3*sin(20*t)");
    d.source = "sin(3*t)*x", d.sides.x_max = side(SideKind::dirichlet, "y*sin(5*t)");
    return d;
  };
  FieldRun full(plates("implicit_euler"), 0.02), linear(plates("linear_implicit_euler"), 0.02);
  FieldRun other(plates("trapezoid"), 0.02);
  full.steps(20), linear.steps(20), other.steps(20);
  double apart = 0, control = 0;
  for (size_t i = 0; i < full.values().size(); ++i) {
    apart = std::max(apart, std::abs(full.values()[i] - linear.values()[i]));
    control = std::max(control, std::abs(full.values()[i] - other.values()[i]));
  }
  EXPECT_LT(apart, 1e-9);
  EXPECT_GT(control, 1e-4);
  // One Newton step has one system to solve per step.
  EXPECT_EQ(linear.observed("integrator.steps"), 20);
  EXPECT_EQ(linear.observed("integrator.rates"), 20);
  EXPECT_GT(full.observed("integrator.rates"), 20);
}

TEST(FieldEuler, WhatNeedsForcesIsStillRefused) {
  const auto refused = [](const char* method) -> std::string {
    try {
      FieldRun run(plate(method), 0.01);
    } catch (const Error& e) {
      return e.issues().at(0).pointer + ' ' + e.issues().at(0).allowed;
    }
    return "";
  };
  EXPECT_EQ(refused("implicit_euler"), "");
  const std::string why = refused("projective_dynamics");
  EXPECT_TRUE(why.starts_with("/integrator ")) << why;
  for (const char* method : kEuler)
    EXPECT_NE(why.find(std::string(" ") + method + ","), std::string::npos) << why;
}

}  // namespace
}  // namespace truestep::test
