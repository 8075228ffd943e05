// Plates, a strip bent far and a roof, against plate theory, the elastica and the benchmark's deflection.
#include <gtest/gtest.h>

#include "engine/math/trig.h"
#include "tests/unit/fem/fem_rig.h"

namespace truestep {
namespace {

using namespace fem;
using testing_rig::FemRun;

FemDef shell(double thickness, double poisson) {
  FemDef d;
  d.plane = Plane::shell, d.element = Cell::tri6, d.material = Law::corotated;
  d.plane_thickness = thickness, d.poisson_ratio = poisson, d.youngs_modulus = 1e9;
  d.motion = Motion::quasi_static;
  return d;
}

double rigidity(const FemDef& d) {
  const double h = d.plane_thickness;
  return d.youngs_modulus * h * h * h / (12 * (1 - d.poisson_ratio * d.poisson_ratio));
}

/// Deflection of a square plate's middle over q a^4 / D.
double plate(int cells, bool clamped, double skew) {
  FemDef d = shell(0.01, 0.3);
  // Unequal cells: the middle stays in place, so that a node is there.
  d.quad = QuadShape{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, cells, cells};
  if (skew > 0) {
    d.quad.reset();
    d.mesh = CellsShape{};
    d.mesh->form = Form::triangles;
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells; ++i) {
        const double u = static_cast<double>(i) / cells, v = static_cast<double>(j) / cells;
        // The same fraction of a cell on every mesh.
        const double bump = skew * 8 / cells * u * (1 - u) * v * (1 - v) * (i % 2 == j % 3 % 2 ? 1 : -1);
        const bool middle = 2 * i == cells && 2 * j == cells;
        d.mesh->vertices.push_back({u + (middle ? 0 : bump), v - (middle ? 0 : bump), 0});
      }
    }
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        const int p = j * (cells + 1) + i, q = p + cells + 1;
        for (const int k : {p, p + 1, q + 1, p, q + 1, q}) d.mesh->cells.push_back(k);
      }
    }
  }
  (clamped ? d.clamped : d.pinned) = {"border"};
  // Pa: the plate deflects by some thousandths of its thickness, which stiffens it by the square of that, and
  // far enough for its forces to exceed the rounding of its in-plane stiffness.
  constexpr double kLoad = 1;
  LoadDef load;
  load.on = "all", load.z = "1";
  d.loads = {load};
  FemRun run(d);
  run.step();
  return run.displacement_at({0.5, 0.5, 0}).z * rigidity(d) / kLoad;
}

// Timoshenko, Woinowsky-Krieger 1959, tables 8 and 35, with more digits from the series.
constexpr double kSupported = 0.00406235, kClamped = 0.00126532;

TEST(FemShell, PlatesDeflectAsPlateTheorySays) {
  for (const double skew : {0.0, 0.3}) {
    for (const bool clamped : {false, true}) {
      const double exact = clamped ? kClamped : kSupported;
      const double coarse = plate(8, clamped, skew) / exact - 1, fine = plate(16, clamped, skew) / exact - 1;
      // Of second order: a quarter with halved cells. The bound was set after a run.
      EXPECT_LT(std::abs(fine), 0.05) << clamped << skew;
      EXPECT_GT(std::abs(coarse), 2.5 * std::abs(fine)) << clamped << skew << ": " << coarse << " " << fine;
    }
  }
}

TEST(FemShell, AStripIsAnElastica) {
  // F L^2 / E I = 1: down 0.30172, back 0.05643 (Mattiasson 1981).
  FemDef d = shell(0.002, 0);
  d.quad = QuadShape{{{0, 0, 0}, {1, 0, 0}, {1, 0.1, 0}, {0, 0.1, 0}}, 20, 2};
  d.clamped = {"x0"};
  const double bending = d.youngs_modulus * 0.1 * 0.002 * 0.002 * 0.002 / 12;
  LoadDef load;
  load.on = "x1", load.force = Vec3{0, 0, -bending};
  d.loads = {load};
  d.load_time = 0.2;
  FemRun run(d, 0.05);
  run.step(4);
  const Vec3 tip = run.displacement_at({1, 0.05, 0});
  EXPECT_NEAR(tip.z, -0.30172, 0.01 * 0.30172);
  EXPECT_NEAR(tip.x, -0.05643, 0.02 * 0.05643);
}

TEST(FemShell, TheRoofOfScordelisAndLo) {
  // R = L / 2 = 25, 40 degrees to either side, t = 0.25, E = 4.32e8, nu = 0, a load of 90 per area; the
  // middle of the free side sinks by 0.3024 (MacNeal, Harder 1985). A thousandth of the load, so that it
  // stays linear.
  constexpr int kCells = 16;
  FemDef d = shell(0.25, 0);
  d.youngs_modulus = 4.32e8;
  d.mesh = CellsShape{};
  d.mesh->form = Form::triangles;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const double angle = (2.0 * i / kCells - 1) * 40 * 3.14159265358979323846 / 180;
      const auto [sine, cosine] = trig::sincos(angle);
      d.mesh->vertices.push_back({25 * sine, 25 * cosine, 50.0 * j / kCells});
    }
  }
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      const int p = j * (kCells + 1) + i, q = p + kCells + 1;
      for (const int k : {p, p + 1, q + 1, p, q + 1, q}) d.mesh->cells.push_back(k);
    }
  }
  d.sets = {{"near", {}, std::nullopt, Vec3{100, 100, 0}}, {"far", {}, Vec3{-100, -100, 50}, std::nullopt}};
  HoldDef near, far, middle;
  near.on = "near", near.x = "0", near.y = "0";
  far = near, far.on = "far";
  d.sets.push_back({"one", {kCells / 2 * (kCells + 1) + kCells / 2}, std::nullopt, std::nullopt});
  middle.on = "one", middle.z = "0";
  d.holds = {near, far, middle};
  LoadDef load;
  load.on = "all", load.y = "-0.09";
  d.loads = {load};
  FemRun run(d);
  run.step();
  const double sinks = -1000 * run.displacement(kCells / 2 * (kCells + 1)).y;
  EXPECT_NEAR(sinks, 0.3024, 0.05 * 0.3024);
}

}  // namespace
}  // namespace truestep
