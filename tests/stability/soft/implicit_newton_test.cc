// implicit_euler solves its equations on cloth that buckles and on ropes stiff enough for rounding to matter,
// where Newton's method with full steps, the control, fails.
#include <Eigen/SparseCholesky>
#include <cstdio>

#include "engine/base/errors.h"
#include "engine/integrators/implicit/newton/stage_newton.h"
#include "engine/math/block_sparse.h"
#include "tests/support/block_sparse_eigen.h"
#include "tests/unit/soft/mass_spring_rig.h"

namespace truestep {
using namespace mass_spring;
namespace {

using testing_rig::SpringRun;
constexpr double kStep = 1.0 / 60;

// A square of cloth that falls from nearly horizontal between two pins: every spring is compressed sooner or
// later, and with next to no bending stiffness nothing keeps it straight then.
MassSpringDef buckling_cloth() {
  MassSpringDef d;
  d.cloth_grid = ClothGridShape{
      .origin = {-0.7, 1.9, 0}, .edge_u = {1.4, 0, 0}, .edge_v = {0, -0.9, 0.9}, .nx = 20, .ny = 18};
  d.density = 0.25;
  d.stiffness = 400, d.shear_stiffness = 120, d.bending_stiffness = 2;
  d.pinned = {"corner_00", "corner_10"};
  d.integrator = "implicit_euler";
  return d;
}

MassSpringDef stiff_rope() {
  MassSpringDef d;
  d.rope = RopeShape{.from = {0, 2, 0}, .to = {1, 2, 0}, .links = 20};
  d.pinned = {"first"};
  d.mass = 0.01, d.stiffness = 1e6;
  d.integrator = "implicit_euler";
  return d;
}

const NewtonReport& report(SpringRun& run) {
  return run.workspace.object<NewtonReport>(kNewtonReport);
}

// One step of implicit Euler by Newton's method with full steps and the exact Jacobian: the integrator
// without its line search. Residual norms in `norms`; false if 50 iterations do not converge.
bool plain_newton(SpringRun& run, double h, std::vector<double>& norms) {
  const ForceField& field = run.system->springs();
  Evaluation e{run.workspace, run.arena};
  BlockSparse dfdx, dfdv;
  field.jacobian_pattern(run.state, dfdx, dfdv);
  const auto w = field.inverse_mass(run.state);
  const auto n = static_cast<Eigen::Index>(run.x().size());
  const Eigen::VectorXd x0 = Eigen::Map<Eigen::VectorXd>(run.x().data(), n);
  const Eigen::VectorXd v0 = Eigen::Map<Eigen::VectorXd>(run.v().data(), n);
  Eigen::VectorXd x = x0 + h * v0, v = v0, a(n), r(n);
  norms.clear();
  for (int it = 0; it < 50; ++it) {
    const std::span<const double> xs{x.data(), run.x().size()}, vs{v.data(), run.x().size()};
    const Phase at{h * static_cast<double>(run.steps + 1), xs, vs, run.state};
    field.acceleration(at, {a.data(), run.x().size()}, e);
    double norm2 = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      const double wk = w[static_cast<size_t>(k) / 3];
      r[k] = wk > 0 ? (h * a[k] - (v[k] - v0[k])) / wk : 0;
      norm2 += wk * r[k] * r[k];
    }
    norms.push_back(std::sqrt(norm2));
    if (!std::isfinite(norms.back()) || norms.back() > 1e12) return false;
    if (norms.back() <= 1e-13 * norms.front()) break;
    field.jacobian(at, dfdx, dfdv, e);
    Eigen::SparseMatrix<double> m = -h * h * to_eigen(dfdx) - h * to_eigen(dfdv);
    for (Eigen::Index c = 0; c < n; ++c) {
      const double wc = w[static_cast<size_t>(c) / 3];
      for (Eigen::SparseMatrix<double>::InnerIterator i(m, c); i; ++i) {
        if (wc == 0 || w[static_cast<size_t>(i.row()) / 3] == 0) i.valueRef() = 0;
        if (i.row() == c) i.valueRef() += wc == 0 ? 1 : 1 / wc;
      }
    }
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(m);
    v += ldlt.solve(r);
    x = x0 + h * v;
    if (it == 49) return false;
    // Stops at rounding as well.
    if (norms.size() > 3 && norms.back() > 0.5 * norms[norms.size() - 2] &&
        norms.back() < 1e-9 * norms.front())
      break;
  }
  Eigen::Map<Eigen::VectorXd>(run.x().data(), n) = x;
  Eigen::Map<Eigen::VectorXd>(run.v().data(), n) = v;
  ++run.steps;
  return true;
}

// Implicit Euler removes energy in every step of a cloth without damping; rounding of energies of 10 J is
// 1e-14.
TEST(ImplicitNewton, BucklingClothHoldsAndItsEnergyNeverGrows) {
  SpringRun run(buckling_cloth());
  double energy = run.observe("energy.total");
  int most = 0, definite = 0;
  for (int i = 0; i < 90; ++i) {
    run.step(kStep);
    const double now = run.observe("energy.total");
    EXPECT_LE(now, energy + 1e-12) << "step " << i;
    energy = now;
    most = std::max(most, report(run).iterations);
    definite += report(run).definite;
    EXPECT_LE(report(run).iterations, 150) << "step " << i;
  }
  std::printf("most iterations %d, with a part of the definite Jacobian %d of 90 steps\n", most, definite);
  EXPECT_GT(definite, 0) << "the cloth did not buckle";
}

// Springs ten times stiffer that start compressed by a quarter: the first step alone decides.
TEST(ImplicitNewton, CompressedClothBurstsWithoutGainingEnergy) {
  MassSpringDef d = buckling_cloth();
  d.stiffness = 4000, d.rest_scale = 1.3;
  SpringRun run(d);
  double energy = run.observe("energy.total");
  for (int i = 0; i < 30; ++i) {
    run.step(kStep);
    const double now = run.observe("energy.total");
    EXPECT_LE(now, energy + 1e-9) << "step " << i;
    energy = now;
  }
  // Control: full steps without a line search fail.
  SpringRun control(d);
  std::vector<double> norms;
  bool held = true;
  for (int i = 0; i < 30 && held; ++i) held = plain_newton(control, kStep, norms);
  EXPECT_FALSE(held);
}

// The gallery's hanging cloth with wind and damping, through its first snap.
TEST(ImplicitNewton, HangingClothInTheWindHolds) {
  MassSpringDef d = buckling_cloth();
  d.cloth_grid->nx = 40, d.cloth_grid->ny = 36;
  d.internal_damping = 0.02, d.damping = 1e-4;
  d.wind = Vec3{0.6, 0, 3}, d.gust = 0.8, d.gust_period = 2.5;
  SpringRun run(d);
  run.step(kStep, 30);
  EXPECT_LT(run.observe("strain.max"), 0.5);
}

// The gallery's hanging cloth starts 15 % compressed, with damping along its springs and wind: in the first
// step folds grow from nothing, and with them the directions in which the damping acts. No solution was found
// there.
MassSpringDef compressed_damped_cloth() {
  MassSpringDef d = buckling_cloth();
  d.cloth_grid = ClothGridShape{
      .origin = {-0.55, 1.9, 0}, .edge_u = {1.1, 0, 0}, .edge_v = {0, -0.85, 0.85}, .nx = 40, .ny = 36};
  d.rest_scale = 1.15, d.internal_damping = 0.02, d.damping = 1e-4;
  return d;
}

TEST(ImplicitNewton, CompressedDampedClothInTheWindHolds) {
  MassSpringDef d = compressed_damped_cloth();
  d.wind = Vec3{0.3, 0, 1}, d.gust = 0.8, d.gust_period = 2.5;
  SpringRun run(d);
  run.step(kStep);
  const NewtonReport first = report(run);
  EXPECT_LE(first.iterations, 300);
  EXPECT_LE(first.last, std::max(first.target, first.floor));
  // The control: the full equations found no solution, nor do full steps.
  EXPECT_TRUE(first.held);
  SpringRun control(d);
  std::vector<double> norms;
  EXPECT_FALSE(plain_newton(control, kStep, norms));
  // Once the cloth is folded, they are solved.
  int held = 0;
  for (int i = 0; i < 10; ++i) {
    run.step(kStep);
    held += report(run).held;
    EXPECT_LE(report(run).iterations, 150) << "step " << i;
  }
  EXPECT_LE(held, 1);
  EXPECT_LT(run.observe("strain.max"), 0.3);
  // All of them are counted, also after the state was saved and restored.
  EXPECT_EQ(run.observe("integrator.held_steps"), held + 1);
  run.state = State::deserialize(run.state.serialize());
  EXPECT_EQ(run.observe("integrator.held_steps"), held + 1);
}

// The count exists where it is meaningful: with damping to hold back, under the method that does so.
TEST(ImplicitNewton, HeldStepsAreObservedWhereThereIsDampingToHold) {
  const auto observed = [](MassSpringDef d, const char* method) {
    d.integrator = method;
    Observables out;
    const SpringRun run(d);
    run.system->observe(run.state, 0, out);
    return out.find("integrator.held_steps");
  };
  MassSpringDef undamped = compressed_damped_cloth();
  undamped.internal_damping = undamped.damping = 0;
  EXPECT_EQ(observed(compressed_damped_cloth(), "implicit_euler"), 0);
  EXPECT_FALSE(observed(undamped, "implicit_euler"));
  EXPECT_FALSE(observed(compressed_damped_cloth(), "linear_implicit_euler"));
}

// Without wind no energy is supplied; of some 0.5 J, rounding is 1e-14, and the tolerance far less than 1e-9.
TEST(ImplicitNewton, CompressedDampedClothNeverGainsEnergy) {
  SpringRun run(compressed_damped_cloth());
  double energy = run.observe("energy.total");
  const double start = energy;
  for (int i = 0; i < 10; ++i) {
    run.step(kStep);
    const double now = run.observe("energy.total");
    EXPECT_LE(now, energy + 1e-9) << "step " << i;
    energy = now;
  }
  // The control: there was energy to lose.
  EXPECT_LT(energy, start - 0.01);
}

// 1e6 N/m and 10 g: a position's rounding of 1e-16 m is a force of 1e-10 N, as much as the tolerance allows.
TEST(ImplicitNewton, StiffRopeStopsAtTheRoundingOfItsForces) {
  SpringRun run(stiff_rope());
  double energy = run.observe("energy.total");
  int out_of_reach = 0;
  for (int i = 0; i < 600; ++i) {
    run.step(kStep);
    const double now = run.observe("energy.total");
    // Energies of 4 J, and springs' of 1e6 * 1e-16 m * their strain.
    EXPECT_LE(now, energy + 1e-12) << "step " << i;
    energy = now;
    const NewtonReport& r = report(run);
    EXPECT_LE(r.residuals[r.iterations], std::max(r.target, r.floor)) << "step " << i;
    // Control: without the floor the tolerance would demand more than is possible.
    out_of_reach += r.residuals[r.iterations] > r.target;
  }
  EXPECT_GT(out_of_reach, 0);
}

// Where the floor stops the iteration, positions are exact to a few units of rounding: the same step shifted
// by a power of two, which changes all roundings, differs by that much. 2 units in the residual, two runs,
// |x| <= 2.5 m, and some tens of points over which an error accumulates: 1e-14 m. Control: a stiffness larger
// by a millionth is detected by far.
TEST(ImplicitNewton, RoundingFloorCostsNoAccuracy) {
  const auto end = [](double shift, double stiffness) {
    MassSpringDef d = stiff_rope();
    d.rope->from.y += shift, d.rope->to.y += shift;
    d.rope->to.x = 1 + 1e-4, d.rope->length = 1, d.stiffness = stiffness;
    SpringRun run(d);
    run.step(kStep);
    return run.position(20) - Vec3{0, shift, 0};
  };
  const Vec3 here = end(0, 1e6);
  EXPECT_LT(norm(end(0.5, 1e6) - here), 1e-13);
  EXPECT_GT(norm(end(0, 1e6 * (1 + 1e-6)) - here), 1e-13);
}

// Stretched cloth that swings: plain Newton converges, so both must agree; both are solved to 1e-12 or better
// of velocities of 1 m/s. Control: the linearised method is another method.
TEST(ImplicitNewton, AgreesWithPlainNewtonWhereThatConverges) {
  MassSpringDef d = buckling_cloth();
  d.rest_scale = 0.8, d.pinned = {"corners"};
  d.newton_tolerance = 1e-13;
  SpringRun ours(d), plain(d);
  d.integrator = "linear_implicit_euler";
  SpringRun linear(d);
  std::vector<double> norms;
  for (int i = 0; i < 20; ++i) {
    ours.step(0.00025);
    linear.step(0.00025);
    ASSERT_TRUE(plain_newton(plain, 0.00025, norms)) << i;
  }
  double worst = 0, control = 0, size = 0;
  for (size_t k = 0; k < ours.v().size(); ++k) {
    worst = std::max(worst, std::abs(ours.v()[k] - plain.v()[k]));
    control = std::max(control, std::abs(linear.v()[k] - plain.v()[k]));
    size = std::max(size, std::abs(plain.v()[k]));
  }
  EXPECT_LT(worst, 1e-10 * size);
  EXPECT_GT(control, 1e-6 * size);
}

// Near the solution an iteration squares the residual, until rounding (8e-13 here): of three consecutive
// norms the exponent of the last is 2, less the effect of the linear solves, which are no more accurate than
// the gain of the previous iteration. Damping and wind, whose asymmetric derivatives are not in the matrix,
// keep it superlinear. Control: a sequence with a constant gain has the exponent 1.
double order(double e0, double e1, double e2) {
  return std::log(e2 / e1) / std::log(e1 / e0);
}

TEST(ImplicitNewton, ConvergesQuadratically) {
  for (const double damping : {0.0, 0.02}) {
    MassSpringDef d = buckling_cloth();
    d.newton_tolerance = 1e-15;
    if (damping > 0) d.internal_damping = damping, d.wind = Vec3{0.6, 0, 3};
    SpringRun run(d);
    std::vector<double> orders;
    for (int i = 0; i < 15; ++i) {
      run.step(kStep);
      const NewtonReport& r = report(run);
      const double* e = r.residuals;
      for (int k = 2; k <= std::min(r.iterations, NewtonReport::kKept - 1); ++k) {
        // Three norms clear of the start and of rounding.
        if (e[k - 2] < 0.1 * e[0] && e[k - 1] < 0.1 * e[k - 2] && e[k] > 10 * 8e-13) {
          orders.push_back(order(e[k - 2], e[k - 1], e[k]));
        }
      }
    }
    ASSERT_GT(orders.size(), 4u) << damping;
    std::sort(orders.begin(), orders.end());
    std::printf("damping %g: orders from %.2f, median %.2f, to %.2f\n", damping, orders.front(),
                orders[orders.size() / 2], orders.back());
    EXPECT_GT(orders[orders.size() / 2], damping > 0 ? 1.3 : 1.6) << damping;
  }
  EXPECT_LT(order(1e-2, 1e-3, 1e-4), 1.1);
}

// Simplified iterations fail on a stiff flat net that starts to sag, as every spring turns, and from 1e6 N/m
// Newton's method with shortened increments does too. The field's own minimisation follows then (BDF2 begins
// with a step of TR-BDF2).
MassSpringDef flat_net(double stiffness, const char* method) {
  MassSpringDef d;
  d.cloth_grid = ClothGridShape{.edge_u = {1, 0, 0}, .edge_v = {0, 0, 1}, .nx = 6, .ny = 6};
  d.density = 0.25;
  d.stiffness = stiffness, d.shear_stiffness = 100, d.bending_stiffness = 2;
  d.pinned = {"corners"};
  d.integrator = method;
  return d;
}

TEST(ImplicitNewton, Bdf2BeginsOnAStiffNetAtRest) {
  for (const double stiffness : {1e4, 1e6, 1e8}) {
    SpringRun run(flat_net(stiffness, "bdf2"));
    run.step(kStep);
    // Between free fall, g h^2 / 2 and a part of it that the method's error may add, and rest.
    for (size_t i = 0; i < 36; ++i) {
      EXPECT_GE(run.position(i).y, -1.1 * 0.5 * 9.81 * kStep * kStep) << i;
      EXPECT_LE(run.position(i).y, 1e-12) << i;
    }
    EXPECT_LT(run.position(14).y, -1e-4 * std::min(1.0, 1e4 / stiffness)) << stiffness;
    for (int n = 1; n < 60; ++n) ASSERT_NO_THROW(run.step(kStep)) << stiffness << ' ' << n;
  }
}

/// The most energy in a second of a net that flies along itself, over what it starts with: its springs are
/// pressed together in one direction.
double most_energy_of_thrown_net(const char* method, double step) {
  MassSpringDef d = flat_net(300, method);
  d.velocity = {5, 0, 0};
  SpringRun run(d);
  const double start = run.observe("energy.total");
  double most = start;
  for (int n = 0; n * step < 1; ++n) {
    run.step(step);
    most = std::max(most, run.observe("energy.total"));
  }
  return most / start;
}

// Nothing can give it energy: bdf2 loses some at any step. The others keep theirs only where the step
// resolves how the net buckles: at a sixtieth they are the control, and a session ends with an event there.
TEST(ImplicitNewton, FixedStepsOfANetThrownAlongItself) {
  constexpr double kRounding = 1 + 1e-9;
  ASSERT_NO_THROW(EXPECT_LE(most_energy_of_thrown_net("bdf2", kStep), kRounding));
  for (const char* method : {"implicit_midpoint", "trapezoid", "newmark", "generalized_alpha"}) {
    ASSERT_NO_THROW(EXPECT_LE(most_energy_of_thrown_net(method, kStep / 16), 1.01) << method);
    ASSERT_NO_THROW(EXPECT_GT(most_energy_of_thrown_net(method, kStep), 10) << method);
  }
}

}  // namespace
}  // namespace truestep
