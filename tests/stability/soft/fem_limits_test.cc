// Elastic bodies at the limits: stiffness over seven and steps over two powers of ten, cells a thousand times
// longer than thick, elements turned inside out or pressed flat.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "tests/unit/fem/fem_rig.h"

namespace truestep {
namespace {

using fem::Cell;
using fem::FemColumns;
using fem::FemDef;
using fem::Law;
using fem::Meeting;
using testing_rig::FemRun;

FemDef block(const Vec3& size, Cell cell) {
  FemDef d;
  d.block = SoftBlockShape{
      .origin = {-0.5 * size.x, 0, -0.5 * size.z}, .size = size, .cells_x = 2, .cells_y = 2, .cells_z = 2};
  d.element = cell;
  return d;
}

// Implicit Euler removes energy and never adds any: a body held on one side and released, or falling onto the
// ground behind a barrier, never has more than at the start.
void expect_no_gain(const FemDef& d, double dt, int steps) {
  FemRun run(d, dt, {0, -9.81, 0});
  const double start = run.observe("energy.total"),
               scale = 9810 * d.block->size.x * d.block->size.y * d.block->size.z;
  for (int k = 0; k < 20; ++k) {
    run.step(static_cast<uint64_t>(steps));
    const double now = run.observe("energy.total");
    // Steps end where Newton's method has converged, to 1e-6 of the forces.
    ASSERT_LT(now, start + 1e-4 * scale)
        << static_cast<int>(d.material) << ' ' << d.youngs_modulus << ' ' << dt;
  }
}

TEST(FemLimits, NoStiffnessAndNoStepGainsEnergy) {
  for (const Law law : {Law::corotated, Law::neo_hookean, Law::stable_neo_hookean}) {
    for (const double stiffness : {1e2, 1e5, 1e9}) {
      for (const double dt : {1.0 / 30, 1.0 / 240, 1.0 / 1000}) {
        FemDef d = block({1, 1, 1}, Cell::tet4);
        d.material = law, d.youngs_modulus = stiffness, d.pinned = {"x0"};
        expect_no_gain(d, dt, dt > 0.01 ? 1 : 5);
      }
    }
  }
}

TEST(FemLimits, CellsAThousandTimesAsLongAsThickSwingWithoutGainingEnergy) {
  // Two cells of 0.5 m along, two of 0.5 mm across.
  FemDef d = block({1, 1e-3, 0.5}, Cell::hex8);
  d.material = Law::corotated, d.youngs_modulus = 1e9, d.pinned = {"x0"};
  expect_no_gain(d, 1.0 / 60, 2);
}

TEST(FemLimits, FlatCellsFallBehindABarrierWithoutGainingEnergy) {
  FemDef d = block({1, 0.02, 1}, Cell::tet4);
  d.youngs_modulus = 1e6, d.block->origin.y = 0.05;
  d.colliders.push_back(PlaneColliderDef{}), d.contact = Meeting::barrier;
  expect_no_gain(d, 1.0 / 60, 2);
}

// One element turned inside out, one pressed to a plane, one to a point: each law that resists collapse
// brings them back, and the others still have finite energies.
TEST(FemLimits, WhatIsTurnedInsideOutRecovers) {
  for (const Law law : {Law::corotated, Law::neo_hookean, Law::stable_neo_hookean, Law::mooney_rivlin}) {
    for (const Cell cell : {Cell::tet4, Cell::hex8, Cell::tet10}) {
      for (const double squeeze : {-0.6, 0.0}) {
        FemDef d = block({1, 1, 1}, cell);
        d.material = law, d.second_share = law == Law::mooney_rivlin ? 0.2 : 0;
        d.youngs_modulus = 1e5, d.damping = 5, d.pinned = {"bottom"};
        FemRun run(d, 1.0 / 60);
        // The upper layer of nodes goes down through the middle one.
        const auto x = run.state.f64(FemColumns::position);
        for (size_t i = 0; i < x.size() / 3; ++i) {
          if (x[3 * i + 1] > 0.5) x[3 * i + 1] = 0.5 + squeeze * (x[3 * i + 1] - 0.5);
        }
        ASSERT_LE(run.observe("jacobian.min"), 1e-9);
        run.step(300);
        const auto what = [&] {
          return std::to_string(static_cast<int>(law)) + ' ' + std::string(element_of(kind_of(cell)).name) +
                 ' ' + std::to_string(squeeze);
        };
        ASSERT_TRUE(std::isfinite(run.observe("energy.total"))) << what();
        EXPECT_GT(run.observe("jacobian.min"), 0.9) << what();
        EXPECT_LT(run.observe("displacement.max"), 1e-2) << what();
      }
    }
  }
}

// A body that falls 1 m onto a plane receives at most m g h, whatever its stiffness: nodes moved back by a
// collider after the step used to squeeze elements of 1e9 Pa until 9.8e3 J had become 4.7e7 J.
TEST(FemLimits, NodesThatMeetACollisionNeverGainEnergy) {
  const auto drop = [](FemDef d, double dt, const char* what) {
    d.block->origin.y = 1;
    d.colliders.push_back(PlaneColliderDef{});
    FemRun run(d, dt, {0, -9.81, 0});
    const double start = run.observe("energy.total"),
                 scale = 9810 * d.block->size.x * d.block->size.y * d.block->size.z;
    for (int k = 0; k < 40; ++k) {
      run.step(static_cast<uint64_t>(std::max(1.0, 0.025 / dt)));
      // A step may gain a hundredth of the energy of motion (surface_contacts.h), once per impact.
      ASSERT_LT(run.observe("energy.total"), start + 0.02 * scale)
          << what << ' ' << d.youngs_modulus << ' ' << k;
    }
    // It rests on the plane.
    EXPECT_GT(run.observe("jacobian.min"), 0.5) << what;
    const auto x = run.state.f64(FemColumns::position);
    double lowest = 1e9;
    for (size_t i = 1; i < x.size(); i += 3) lowest = std::min(lowest, x[i]);
    EXPECT_GT(lowest, -1e-3) << what;
    EXPECT_LT(lowest, 0.1) << what;
  };
  for (const double stiffness : {1e5, 1e9}) {
    FemDef d = block({1, 1, 1}, Cell::tet4);
    d.youngs_modulus = stiffness;
    drop(d, 1.0 / 30, "block");
    d.material = Law::corotated, d.element = Cell::hex8;
    drop(d, 1.0 / 30, "corotated");
  }
  // Thinner than its motion in a step.
  FemDef d = block({1, 0.02, 1}, Cell::tet4);
  d.youngs_modulus = 1e7;
  drop(d, 1.0 / 30, "slab");
  // On a corner, so that it rotates.
  d = block({1, 1, 1}, Cell::tet4);
  d.youngs_modulus = 1e9, d.copies = {{.position = {0, 1, 0}, .axis = {1, 0, 0.3}, .angle = 0.6}};
  drop(d, 1.0 / 30, "turned");
}

// Solid cells 250 mm long and 1 mm or 0.1 mm thick in equilibrium: the softest mode is 1e13 and 1e16 times
// softer than the stiffest. The first is found; the second, which double precision cannot tell from rounding,
// is refused. Both used to stay where they began, without a message.
TEST(FemLimits, StripsOfSolidCellsBendUnderTheirWeightOrSayThatTheyCannot) {
  const auto strip = [](double thickness, double youngs, Cell cell) {
    FemDef d;
    d.block = SoftBlockShape{.size = {1, thickness, 0.5}, .cells_x = 4, .cells_y = 1, .cells_z = 1};
    d.element = cell, d.material = Law::linear, d.youngs_modulus = youngs, d.poisson_ratio = 0;
    d.pinned = {"x0"}, d.motion = fem::Motion::quasi_static;
    return d;
  };
  const auto beam = [](double thickness, double youngs) {
    return 1000 * 9.81 * thickness / (8 * youngs * thickness * thickness * thickness / 12);
  };
  for (const double thickness : {1e-2, 1e-3}) {
    FemRun run(strip(thickness, 2e12, Cell::hex27), 1, {0, -9.81, 0});
    run.step();
    // Four quadratic cells and nodal loads have an error of 2 % (seen at both thicknesses, and the bound was
    // set after that); a solve that ends too early is off by a quarter and more.
    EXPECT_NEAR(run.observe("displacement.max"), beam(thickness, 2e12), 0.03 * beam(thickness, 2e12))
        << thickness;
  }
  try {
    FemRun run(strip(1e-5, 2e16, Cell::hex27), 1, {0, -9.81, 0});
    run.step();
    EXPECT_NEAR(run.observe("displacement.max"), beam(1e-5, 2e16), 0.1 * beam(1e-5, 2e16));
  } catch (const Instability& failure) {
    EXPECT_NE(std::string(failure.what()).find("no equilibrium was found"), std::string::npos);
  }
}

}  // namespace
}  // namespace truestep
