// Vertex block descent of elastic bodies (fem_descent.cc): a node's force and stiffness are those of the
// whole element, and the steps converge to those of implicit Euler. Costs 1 s.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/kernels/fem/cell.h"
#include "tests/unit/fem/fem_rig.h"

namespace truestep {
namespace {

using namespace fem;
using testing_rig::FemRun;

FemDef beam(Law law, const char* method, int iterations) {
  FemDef d;
  d.block = SoftBlockShape{.size = {1, 0.25, 0.25}, .cells_x = 4, .cells_y = 1, .cells_z = 1};
  d.element = Cell::tet4, d.material = law, d.youngs_modulus = 1e5, d.damping = 0.5, d.pinned = {"x0"};
  d.integrator = method;
  if (iterations > 0) d.descent_iterations = iterations;
  d.newton_tolerance = 1e-11;
  return d;
}

TEST(FemDescent, ANodeFeelsWhatItsElementSays) {
  for (const Law law : {Law::linear, Law::corotated, Law::st_venant_kirchhoff, Law::neo_hookean,
                        Law::stable_neo_hookean, Law::mooney_rivlin}) {
    for (const Cell cell : {Cell::tet4, Cell::tet10, Cell::hex8}) {
      FemDef d = beam(law, "", 0);
      d.element = cell, d.second_share = law == Law::mooney_rivlin ? 0.2 : 0;
      FemRun run(d);
      const Body& body = run.system->body();
      std::array<Vec3, kMostNodes> x, forces{};
      run.system->elements().gather(run.state.f64(FemColumns::position).data(), 1, x.data());
      for (size_t a = 0; a < body.size(); ++a)
        x[a].x += 0.02 * std::sin(3.0 * a), x[a].y += 0.03 * std::cos(5.0 * a);
      const Material m = run.system->elements().material(run.state);
      const CellRule rule = run.system->elements().rule(1);
      const size_t n = body.size();
      cell_forces(m, rule, x.data(), forces.data());
      std::vector<double> whole(9 * n * n);
      cell_stiffness(m, rule, x.data(), Definite::yes, whole.data());
      for (size_t a = 0; a < n; ++a) {
        Vec3 force;
        double k[9] = {};
        cell_node(m, rule, x.data(), a, force, k);
        // Rounding of sums of the same numbers.
        EXPECT_LT(norm(force - forces[a]), 1e-10 * (1 + norm(forces[a])));
        for (size_t c = 0; c < 9; ++c)
          EXPECT_NEAR(k[c], whole[9 * (a * n + a) + c], 1e-10 * std::abs(whole[9 * a * (n + 1)]));
      }
    }
  }
}

double apart(const FemRun& a, const FemRun& b) {
  const auto x = a.state.f64(FemColumns::position), y = b.state.f64(FemColumns::position);
  double worst = 0;
  for (size_t k = 0; k < x.size(); ++k) worst = std::max(worst, std::abs(x[k] - y[k]));
  return worst;
}

TEST(FemDescent, ComesToTheStepsOfImplicitEuler) {
  for (const Law law : {Law::stable_neo_hookean, Law::corotated, Law::linear}) {
    FemRun newton(beam(law, "implicit_euler", 0), 1.0 / 60, {0, -9.81, 0});
    FemRun many(beam(law, "vertex_block_descent", 400), 1.0 / 60, {0, -9.81, 0});
    FemRun few(beam(law, "vertex_block_descent", 5), 1.0 / 60, {0, -9.81, 0});
    for (FemRun* run : {&newton, &many, &few}) run->step(10);
    EXPECT_GT(newton.observe("displacement.max"), 0.03);
    // Both stop where forces are balanced to rounding times the condition number, some 1e4; few iterations do
    // not.
    EXPECT_LT(apart(newton, many), 1e-7) << static_cast<int>(law);
    EXPECT_GT(apart(newton, few), 1e-4) << static_cast<int>(law);
  }
}

TEST(FemDescent, SingleComponentsThatAreHeldStay) {
  const auto held = [](const char* method) {
    FemDef d = beam(Law::stable_neo_hookean, method, 300);
    d.pinned.clear();
    d.holds = {{.on = "x0", .x = "0", .y = "0", .z = "0"}, {.on = "x1", .x = {}, .y = {}, .z = "0"}};
    return d;
  };
  FemRun newton(held("implicit_euler"), 1.0 / 60, {0, -9.81, 3}),
      many(held("vertex_block_descent"), 1.0 / 60, {0, -9.81, 3});
  newton.step(5), many.step(5);
  EXPECT_LT(apart(newton, many), 1e-7);
  EXPECT_EQ(many.displacement_at({1, 0, 0}).z, 0);
  FemDef d = held("vertex_block_descent");
  d.descent_iterations = 2;
  FemRun few(d, 1.0 / 60, {0, -9.81, 3});
  few.step(5);
  EXPECT_EQ(few.displacement_at({1, 0, 0}).z, 0);
}

TEST(FemDescent, BodiesWhoseForcesAreNotOfAFewNodesAreRefused) {
  FemDef d = beam(Law::stable_neo_hookean, "vertex_block_descent", 10);
  EXPECT_NO_THROW(FemRun{d});
  d.element = Cell::hex8, d.volume = Volume::mean;
  EXPECT_THROW(FemRun{d}, Error);
}

}  // namespace
}  // namespace truestep
