// The interfaces through which mass_spring serves descent methods (core/equations/stiffness_bound.h,
// core/equations/point_forces.h), and that projective dynamics and vertex block descent converge to the step
// of implicit Euler.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/integrators/table/integrators.h"
#include "engine/math/block_sparse.h"
#include "engine/math/solvers/block_ldlt.h"
#include "engine/systems/mass_spring/mass_spring.h"

namespace truestep {
using namespace mass_spring;
namespace {

using Columns = MassSpringColumns;

MassSpringDef cloth() {
  MassSpringDef d;
  d.cloth_grid = ClothGridShape{.nx = 9, .ny = 7};
  d.mass = 1e-3, d.stiffness = 200, d.shear_stiffness = 40, d.bending_stiffness = 5,
  d.flexural_rigidity = 1e-4;
  d.damping = 1e-3, d.internal_damping = 2e-3;
  d.pinned = {"corner_00", "corner_10"};
  return d;
}

/// Pseudo-random numbers within [-1, 1].
struct Scatter {
  uint32_t state = 1;
  double operator()() {
    state = 1664525 * state + 1013904223;
    return state / 2147483648.0 - 1;
  }
};

State crumpled(const MassSpringField& field, double by) {
  State s = field.initial_state();
  Scatter scatter;
  const auto w = s.f64(Columns::inverse_mass);
  for (size_t k = 0; k < 3 * w.size(); ++k) {
    if (!(w[k / 3] > 0)) continue;
    s.f64(Columns::position)[k] += by * scatter();
    s.f64(Columns::velocity)[k] += scatter();
  }
  return s;
}

State after(const MassSpringField& field, const char* method, int iterations, int steps,
            double h = 1.0 / 60) {
  const Integrator& m = *find_integrator(method);
  State s = field.initial_state();
  if (m.prepare) m.prepare(field, s);
  Workspace workspace;
  const ThreadArena arena(1);
  for (int n = 0; n < steps; ++n) {
    m.step(field, s, {.t = n * h, .h = h, .step = uint64_t(n), .workspace = workspace, .arena = arena},
           {.newton_tolerance = 1e-12, .descent_iterations = iterations});
  }
  return s;
}

double apart(const State& a, const State& b) {
  const auto x = a.f64(Columns::position), y = b.f64(Columns::position);
  double worst = 0;
  for (size_t k = 0; k < x.size(); ++k) worst = std::max(worst, std::abs(x[k] - y[k]));
  return worst;
}

TEST(Descent, TheBoundIsAboveTheStiffnessOfStretchedAndPressedSprings) {
  MassSpringDef d = cloth();
  d.flexural_rigidity = 0;  // bends may be stiffer than at the start
  const MassSpringField field(d, {.id = "c"});
  const State s = crumpled(field, 0.05);
  const double h = 0.01;
  BlockSparse bound, dfdx, dfdv;
  field.bound_pattern(bound);
  field.bound(s, h, bound);
  field.jacobian_pattern(s, dfdx, dfdv);
  Workspace workspace;
  const ThreadArena arena(1);
  Evaluation e{workspace, arena};
  field.jacobian({0, s.f64(Columns::position), s.f64(Columns::velocity), s}, dfdx, dfdv, e);
  const size_t n = s.rows(Columns::position);
  std::vector<double> u(3 * n), k(3 * n), c(3 * n);
  Scatter scatter;
  double nearest = 0;
  for (int trial = 0; trial < 200; ++trial) {
    for (double& component : u) component = scatter();
    dfdx.multiply(u, k, arena), dfdv.multiply(u, c, arena);
    double stiff = 0, most = 0;
    for (size_t i = 0; i < 3 * n; ++i) stiff -= u[i] * (k[i] + c[i] / h);
    for (uint32_t i = 0; i < n; ++i) {
      for (auto slot = bound.row_begin(i); slot < bound.row_begin(i + 1); ++slot) {
        most += bound.values()[slot] * dot(load3(u.data(), i), load3(u.data(), bound.column(slot)));
      }
    }
    EXPECT_LT(stiff, most * (1 + 1e-12));
    nearest = std::max(nearest, stiff / most);
  }
  // The control: half of the bound would not be enough.
  EXPECT_GT(nearest, 0.3);
}

TEST(Descent, PointSlopesAreForceAndItsDerivative) {
  MassSpringDef d = cloth();
  d.wind = Vec3{3, 0, 1};
  const MassSpringField field(d, {.id = "c", .gravity = {0, -9.81, 0}});
  State s = crumpled(field, 0.01);
  Columns::kHands.set_drag(s, 20, {0.5, 0.5, 0.5}, 30, {});
  Columns::kHands.add_push(s, {.who = 21, .force = {1, 2, 3}}, 1);
  Workspace workspace;
  const ThreadArena arena(1);
  Evaluation e{workspace, arena};
  std::vector<double> a(s.f64(Columns::position).size());
  const Phase at{0, s.f64(Columns::position), s.f64(Columns::velocity), s};
  field.acceleration(at, a, e);
  BlockSparse dfdx, dfdv;
  field.jacobian_pattern(s, dfdx, dfdv);
  field.definite_jacobian(at, dfdx, dfdv, e);
  const double h = 0.02;
  size_t seen = 0;
  for (size_t c = 0; c < field.colours().count(); ++c) {
    const auto& colours = field.colours();
    const auto points =
        std::span(colours.points).subspan(colours.begin[c], colours.begin[c + 1] - colours.begin[c]);
    std::vector<PointSlope> out(points.size());
    field.point_slopes(at, at.x, h, points, out);
    for (size_t k = 0; k < points.size(); ++k, ++seen) {
      const uint32_t i = points[k];
      if (!(s.f64(Columns::inverse_mass)[i] > 0)) continue;
      // Sums in another order: rounding of forces of some newtons.
      EXPECT_LT(norm(out[k].force - load3(a.data(), i) * field.masses()[i]), 1e-12 * 100) << i;
      const auto x = dfdx.block(dfdx.diagonal_slot(i)), v = dfdv.block(dfdv.diagonal_slot(i));
      constexpr size_t kPlace[6] = {0, 1, 2, 4, 5, 8};
      for (size_t m = 0; m < 6; ++m) {
        EXPECT_NEAR(out[k].stiffness[m], -x[kPlace[m]] - v[kPlace[m]] / h, 1e-9) << i << " " << m;
      }
    }
  }
  EXPECT_EQ(seen, field.masses().size());
}

TEST(Descent, ThreeRightHandSidesAreThreeSolutions) {
  const MassSpringField field(cloth(), {.id = "c"});
  const State s = field.initial_state();
  BlockSparse a;
  field.bound_pattern(a);
  field.bound(s, 0.01, a);
  for (uint32_t i = 0; i < a.block_rows(); ++i) a.values()[a.diagonal_slot(i)] += 10;
  BlockLdlt factors;
  ASSERT_EQ(factors.factorize(a), BlockLdlt::Outcome::positive_definite);
  const size_t n = a.block_rows();
  Scatter scatter;
  std::vector<double> b(3 * n), x(3 * n), one(n), alone(n);
  for (double& c : b) c = scatter();
  factors.solve_three(b, x);
  for (size_t k = 0; k < 3; ++k) {
    for (size_t i = 0; i < n; ++i) one[i] = b[3 * i + k];
    factors.solve(one, alone);
    for (size_t i = 0; i < n; ++i) EXPECT_NEAR(x[3 * i + k], alone[i], 1e-15);
  }
}

TEST(Descent, BothComeToTheStepOfImplicitEuler) {
  // Internal damping acts along the springs' directions at the start of the step in one, at the end in the
  // other.
  MassSpringDef d = cloth();
  d.internal_damping = 0;
  const MassSpringField field(d, {.id = "c", .gravity = {0, -9.81, 0}});
  const State exact = after(field, "implicit_euler", 1, 12);
  // Both stop at a residual of 1e-12 of the step's first one, or at rounding: forces of 1e-2 N over 200 N/m.
  EXPECT_LT(apart(after(field, "projective_dynamics", 2000, 12), exact), 1e-7);
  EXPECT_LT(apart(after(field, "vertex_block_descent", 3000, 12), exact), 1e-7);
  // The controls: few iterations leave a larger difference, more a smaller one.
  const double few = apart(after(field, "projective_dynamics", 2, 12), exact);
  EXPECT_GT(few, 1e-4);
  EXPECT_LT(apart(after(field, "projective_dynamics", 20, 12), exact), 0.2 * few);
  EXPECT_GT(apart(after(field, "vertex_block_descent", 5, 12), exact), 1e-4);
}

TEST(Descent, RefusesFieldsThatAreNoSprings) {
  const MassSpringField springs(cloth(), {.id = "c"});
  for (const char* name : {"projective_dynamics", "vertex_block_descent"}) {
    EXPECT_FALSE(refusal(*find_integrator(name), springs)) << name;
  }
}

}  // namespace
}  // namespace truestep
