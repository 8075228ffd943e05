// Bending of sheets: exact curvatures of quadratic surfaces, energies invariant under rigid motions, first
// and second derivatives against finite differences, stiffness that is never negative; likewise for
// membranes.
#include "engine/kernels/fem/bending.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "engine/base/random.h"
#include "engine/kernels/fem/cell.h"
#include "tests/support/block_sparse_eigen.h"
#include "tests/unit/fem/fem_rig.h"

namespace truestep {
namespace {

using namespace fem;
using testing_rig::FemRun;

Vec3 shaken(uint64_t which, uint64_t k) {
  const auto u = uniform4(77, which, k);
  return {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
}

Vec3 turned(const Vec3& p) {
  const Mat3 r{{0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6}};
  return r * p + Vec3{0.3, -2, 0.7};
}

const std::array<Vec3, 3> kTriangle{Vec3{0.1, 0.2, 0}, Vec3{1.3, 0.1, 0}, Vec3{0.5, 0.9, 0}};
const std::array<Vec3, 3> kBeside{Vec3{1.3, 0.1, 0}, Vec3{1.6, 1.2, 0}, Vec3{0.5, 0.9, 0}};

std::array<Vec3, 6> six(const std::array<Vec3, 3>& c) {
  return {c[0], c[1], c[2], 0.5 * (c[0] + c[1]), 0.5 * (c[1] + c[2]), 0.5 * (c[2] + c[0])};
}

TEST(FemBending, CurvaturesOfAQuadraticSurfaceAreExact) {
  // z = x^2 + 3 x y - 2 y^2: k_xx = 2, k_yy = -4, k_xy = 3; the trace and the determinant do not depend on
  // the frame.
  const auto t = triangle_curvature(kTriangle);
  double k[3] = {};
  const auto nodes = six(kTriangle);
  for (size_t a = 0; a < 6; ++a) {
    const Vec3& p = nodes[a];
    for (size_t c = 0; c < 3; ++c) k[c] += t.k[c][a] * (p.x * p.x + 3 * p.x * p.y - 2 * p.y * p.y);
  }
  // Rounding of sums of products of some tens.
  EXPECT_NEAR(k[0] + k[1], -2, 1e-12);
  EXPECT_NEAR(k[0] * k[1] - k[2] * k[2], -17, 1e-11);
}

TEST(FemBending, ASmoothSurfaceHasNoJumpAndAKinkHasItsAngle) {
  const auto points = edge_points(kTriangle, 1, kBeside.data(), 2, 0.3);
  const auto one = six(kTriangle), two = six(kBeside);
  for (const EdgePoint& p : points) {
    double smooth = 0, bent = 0, moment = 0;
    const Vec3 from = kTriangle[1], way = normalized(kTriangle[2] - from), out = cross(way, {0, 0, 1});
    for (size_t a = 0; a < 12; ++a) {
      const Vec3 x = a < 6 ? one[a] : two[a - 6];
      smooth += p.jump[a] * (x.x * x.x + 3 * x.x * x.y - 2 * x.y * x.y);
      bent += p.jump[a] * std::abs(dot(x - from, out));
      moment += p.moment[a] * dot(x - from, out) * dot(x - from, out);
    }
    EXPECT_NEAR(smooth, 0, 1e-12);
    EXPECT_NEAR(bent, -2, 1e-12) << "a roof upside down: from both sides it falls towards the edge by 1";
    EXPECT_NEAR(moment, 2, 1e-11) << "k_mm = 2 on both sides";
  }
}

FemDef sheet(Plane plane, bool bent) {
  FemDef d;
  d.plane = plane, d.element = Cell::tri6, d.plane_thickness = 0.05, d.poisson_ratio = 0.3;
  d.youngs_modulus = 1e4, d.material = Law::corotated;
  d.mesh = CellsShape{{{0, 0, 0}, {1, 0.1, 0}, {1.1, 1, 0}, {-0.1, 0.9, 0}}, {0, 1, 2, 0, 2, 3}};
  if (bent) d.mesh->vertices[3].z = 0.4;
  return d;
}

struct Probe {
  explicit Probe(const FemDef& def)
      : run(def), field(run.system->elements()), state(run.system->initial_state()), arena(1) {
    const auto x = state.f64(FemColumns::position);
    rest.assign(x.begin(), x.end());
  }
  double energy(const std::vector<double>& x) { return field.elastic(phase(x), arena); }
  std::vector<double> forces(const std::vector<double>& x) {
    std::vector<double> f(x.size());
    Evaluation e{workspace, arena};
    field.elastic_forces(phase(x), f, e);
    return f;
  }
  Eigen::MatrixXd slope(const std::vector<double>& x, Definite kind) {
    BlockSparse dfdx, dfdv;
    Evaluation e{workspace, arena};
    field.jacobian_pattern(state, dfdx, dfdv);
    kind == Definite::yes ? field.definite_jacobian(phase(x), dfdx, dfdv, e)
                          : field.jacobian(phase(x), dfdx, dfdv, e);
    return to_eigen(dfdx);
  }
  Phase phase(const std::vector<double>& x) {
    velocity.assign(x.size(), 0);
    return {0, x, velocity, state};
  }
  std::vector<double> moved(double by) const {
    std::vector<double> x = rest;
    for (size_t i = 0; i < x.size() / 3; ++i) store3(x.data(), i, load3(x.data(), i) + by * shaken(1, i));
    return x;
  }

  FemRun run;
  const FemField& field;
  State state;
  ThreadArena arena;
  Workspace workspace;
  std::vector<double> rest, velocity;
};

class FemSheet : public ::testing::TestWithParam<std::tuple<Plane, bool>> {
 protected:
  FemDef def() const { return sheet(std::get<0>(GetParam()), std::get<1>(GetParam())); }
};

TEST_P(FemSheet, RestsWithoutForcesHoweverItIsTurned) {
  Probe p(def());
  std::vector<double> x = p.rest;
  const double scale = p.energy(p.moved(0.1));
  for (size_t i = 0; i < x.size() / 3; ++i) store3(x.data(), i, turned(load3(x.data(), i)));
  // Sums of squares of some hundred terms.
  EXPECT_NEAR(p.energy(x), 0, 1e-11 * scale);
  for (const double f : p.forces(x)) EXPECT_NEAR(f, 0, 1e-10 * scale);
}

TEST_P(FemSheet, ForcesAndStiffnessAreDerivatives) {
  Probe p(def());
  const std::vector<double> x = p.moved(0.08);
  const auto f = p.forces(x);
  const Eigen::MatrixXd k = p.slope(x, Definite::no);
  double largest = 0;
  for (const double v : f) largest = std::max(largest, std::abs(v));
  for (size_t i = 0; i < x.size(); ++i) {
    constexpr double kStep = 1e-5;
    std::vector<double> up = x, down = x;
    up[i] += kStep, down[i] -= kStep;
    // Central differences: of second order in the step, with rounding over it.
    EXPECT_NEAR((p.energy(down) - p.energy(up)) / (2 * kStep), f[i], 1e-6 * largest);
    const auto high = p.forces(up), low = p.forces(down);
    for (size_t j = 0; j < x.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(j), column = static_cast<Eigen::Index>(i);
      EXPECT_NEAR((high[j] - low[j]) / (2 * kStep), k(row, column), 1e-6 * k.cwiseAbs().maxCoeff());
    }
  }
}

// A cylinder of curvature k holds E h^3 k^2 / (24 (1 - nu^2)) an area (Timoshenko, Woinowsky-Krieger 1959,
// eq. 3).
TEST(FemBending, ACylinderHoldsTheEnergyOfItsRigidity) {
  for (const double poisson : {0.0, 0.3, 0.45}) {
    FemDef d = sheet(Plane::shell, false);
    d.poisson_ratio = poisson;
    Probe p(d);
    // So little that what the middle is stretched by holds nothing.
    constexpr double k = 1e-4, h = 0.05;
    std::vector<double> x = p.rest;
    for (size_t i = 0; i < x.size() / 3; ++i) x[3 * i + 2] = 0.5 * k * x[3 * i] * x[3 * i];
    constexpr double area = 0.99;  // of the sheet's corners, by their cross products
    EXPECT_NEAR(p.energy(x) / (1e4 * h * h * h * k * k / (24 * (1 - poisson * poisson)) * area), 1, 1e-3)
        << poisson;
  }
}

TEST_P(FemSheet, TheDefiniteStiffnessIs) {
  Probe p(def());
  for (const double by : {0.0, 0.02, 0.3}) {
    const Eigen::MatrixXd k = -p.slope(p.moved(by), Definite::yes);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 * (k + k.transpose()));
    const auto all = solver.eigenvalues();
    // The term left out of the second derivative of a bent edge has either sign far from rest.
    const bool bent = std::get<1>(GetParam()) && std::get<0>(GetParam()) == Plane::shell && by > 0;
    EXPECT_GT(all.minCoeff(), (bent ? -1e-2 : -1e-11) * all.maxCoeff()) << by;
  }
}

INSTANTIATE_TEST_SUITE_P(All, FemSheet,
                         ::testing::Combine(::testing::Values(Plane::membrane, Plane::shell),
                                            ::testing::Bool()));

}  // namespace
}  // namespace truestep
