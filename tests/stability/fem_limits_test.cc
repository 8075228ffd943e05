// Elastic bodies at the limits: stiffness and steps over seven and two powers of ten, cells a thousand times
// as long as thick, elements turned inside out or pressed flat.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/fem_rig.h"

namespace truestep {
namespace {

using namespace fem;
using testing_rig::FemRun;

FemDef block(const Vec3& size, Cell cell) {
  FemDef d;
  d.block = SoftBlockShape{
      .origin = {-0.5 * size.x, 0, -0.5 * size.z}, .size = size, .cells_x = 2, .cells_y = 2, .cells_z = 2};
  d.element = cell;
  return d;
}

// Implicit Euler takes energy, never gives any: what falls a metre onto the ground is never faster than that.
TEST(FemLimits, NoStiffnessAndNoStepGainsEnergy) {
  for (const Law law : {Law::corotated, Law::neo_hookean, Law::stable_neo_hookean}) {
    for (const double stiffness : {1e2, 1e5, 1e9}) {
      for (const double dt : {1.0 / 30, 1.0 / 240, 1.0 / 1000}) {
        FemDef d = block({1, 1, 1}, Cell::tet4);
        d.material = law, d.youngs_modulus = stiffness;
        d.block->origin.y = 0.5;
        d.colliders.push_back(PlaneColliderDef{});
        FemRun run(d, dt, {0, -9.81, 0});
        const double start = run.observe("energy.total");
        double most = start;
        for (int k = 0; k < 30; ++k) {
          run.seconds(std::max(dt, 0.02));
          const double now = run.observe("energy.total");
          ASSERT_TRUE(std::isfinite(now)) << stiffness << ' ' << dt;
          most = std::max(most, now);
        }
        // What contacts put back against elastic forces may lift the energy by their share of a step: 1e-3 of
        // the weight's, 1 m x 9.81 kN.
        EXPECT_LT(most, start + 10) << static_cast<int>(law) << ' ' << stiffness << ' ' << dt;
      }
    }
  }
}

TEST(FemLimits, CellsAThousandTimesAsLongAsThickBendAsABeam) {
  // A strip of 1 m and a thickness of 0.5 mm in two cells of 0.5 m: 1:2000. Its tip sinks under its own
  // weight by rho g L^4 12 / (8 E h^2), which second-order hexahedra know to a few percent with two of them.
  constexpr double kThick = 0.5e-3;
  FemDef d = block({1, kThick, 0.1}, Cell::hex27);
  d.material = Law::corotated, d.poisson_ratio = 0, d.youngs_modulus = 1e12;
  d.pinned = {"x0"}, d.motion = Motion::quasi_static;
  FemRun run(d, 1, {0, -9.81, 0});
  run.step();
  const double exact = 1000 * 9.81 * 12 / (8 * 1e12 * kThick * kThick);
  EXPECT_NEAR(-run.displacement_at({0.5, 0, 0}).y, exact, 0.05 * exact);
}

TEST(FemLimits, AFlatBlockFallsWithoutGainingEnergy) {
  for (const Cell cell : {Cell::tet4, Cell::hex8}) {
    FemDef d = block({1, 1e-3, 1}, cell);
    d.youngs_modulus = 1e6, d.block->origin.y = 0.1;
    d.colliders.push_back(PlaneColliderDef{});
    FemRun run(d, 1.0 / 120, {0, -9.81, 0});
    const double start = run.observe("energy.total");
    for (int k = 0; k < 60; ++k) {
      run.step(2);
      // As above, of a weight of 9.81 N.
      ASSERT_LT(run.observe("energy.total"), start + 0.01) << k;
    }
  }
}

// One element turned inside out, one pressed to a plane, one to a point: each law that resists collapse
// brings them back, and what does not still has finite energies.
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

}  // namespace
}  // namespace truestep
