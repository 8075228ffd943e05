// Forces of spring networks against their own definitions: the gradient of the potential, finite differences
// of the force, Newton's third law.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "engine/base/random.h"
#include "engine/kernels/springs/spring.h"
#include "engine/math/block_sparse.h"
#include "engine/systems/mass_spring/mass_spring_field.h"
#include "tests/support/block_sparse_eigen.h"

namespace truestep {
using namespace mass_spring;
namespace {

using Columns = MassSpringColumns;

struct Rig {
  explicit Rig(const MassSpringDef& def, Vec3 gravity = {0, -9.81, 0}, int threads = 1)
      : field(def, {.id = "s", .gravity = gravity}), state(field.initial_state()), arena(threads) {}

  std::span<double> x() { return state.f64(Columns::position); }
  std::span<double> v() { return state.f64(Columns::velocity); }
  size_t points() { return field.masses().size(); }
  Phase phase() { return {0.3, x(), v(), state}; }
  Evaluation evaluation() { return {workspace, arena}; }

  std::vector<double> acceleration() {
    std::vector<double> a(x().size());
    auto e = evaluation();
    field.acceleration(phase(), a, e);
    return a;
  }
  /// m a.
  std::vector<double> forces() {
    auto f = acceleration();
    for (size_t i = 0; i < f.size(); ++i) f[i] *= field.masses()[i / 3];
    return f;
  }
  double potential() {
    auto e = evaluation();
    return *field.potential(phase(), e);
  }
  /// Moves every coordinate and velocity by up to the given amounts, always the same way.
  void shake(double by, double speed) {
    uint64_t draw = 0;
    for (double& c : x()) c += by * (2 * uniform4(1, 0, draw++)[0] - 1);
    for (double& c : v()) c += speed * (2 * uniform4(1, 0, draw++)[0] - 1);
  }

  MassSpringField field;
  State state;
  Workspace workspace;
  ThreadArena arena;
};

MassSpringDef hanging_rope() {
  MassSpringDef d;
  d.rope = RopeShape{.from = {0, 0, 0}, .to = {1, 0.2, 0}, .links = 24};
  d.bending_stiffness = 30;
  return d;
}
MassSpringDef hair() {
  MassSpringDef d;
  d.hair = HairShape{.strands = 5, .links = 7};
  d.bending_stiffness = 20;
  return d;
}
MassSpringDef cloth(int n = 9) {
  MassSpringDef d;
  d.cloth_grid = ClothGridShape{.nx = n, .ny = n + 3};
  d.bending_stiffness = 50;
  return d;
}
MassSpringDef mesh() {
  MassSpringDef d;
  d.mesh = MeshShape{.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.1}, {0, 1, 0}, {0.5, 0.5, 0.4}},
                     .triangles = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4}};
  d.bending_stiffness = 10;
  return d;
}
MassSpringDef zero_rest_length() {
  MassSpringDef d = cloth();
  d.rest_scale = 0;
  return d;
}
MassSpringDef own_springs() {
  MassSpringDef d;
  d.free = FreeShape{.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                     .masses = {1, 2, 3},
                     .springs = {{0, 1, 5.0, 0.0}, {1, 2, 7.0, 2.0}, {0, 2, {}, {}}}};
  return d;
}

class Networks : public ::testing::TestWithParam<MassSpringDef (*)()> {};

MassSpringDef big_cloth() {
  return cloth(60);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Networks,
                         ::testing::Values(
                             rope, hair, [] { return cloth(); }, mesh, zero_rest_length, own_springs,
                             big_cloth));

// Central differences of V with step 1e-6 m are good to about 1e-8 relative here; a factor of two in any
// force, or a missing family, is off by order one.
TEST_P(Networks, ForceIsMinusTheGradientOfThePotential) {
  Rig rig(GetParam()());
  rig.shake(0.02, 0);
  const auto f = rig.forces();
  const size_t stride = rig.x().size() > 300 ? 97 : 1;
  for (size_t i = 0; i < rig.x().size(); i += stride) {
    if (rig.state.f64(Columns::inverse_mass)[i / 3] == 0) continue;
    const double at = rig.x()[i], h = 1e-6;
    rig.x()[i] = at + h;
    const double up = rig.potential();
    rig.x()[i] = at - h;
    const double down = rig.potential();
    rig.x()[i] = at;
    ASSERT_NEAR(f[i], -(up - down) / (2 * h), 2e-6 * (1 + std::abs(f[i])) + 1e-9 * std::abs(up) / h)
        << "coordinate " << i;
  }
}

TEST_P(Networks, JacobiansAreTheDerivativesOfTheForces) {
  for (const double wind_speed : {0.0, 3.0}) {
    MassSpringDef def = GetParam()();
    def.damping = 0.1;
    if (wind_speed > 0) {
      def.wind = Vec3{wind_speed, 1, 2};
      // With air drag or damping along springs only df/dv is exact; the elastic test below has neither.
      def.internal_damping = 0.4;
    }
    Rig rig(def);
    rig.shake(0.02, 0.5);
    BlockSparse dfdx, dfdv;
    rig.field.jacobian_pattern(rig.state, dfdx, dfdv);
    auto e = rig.evaluation();
    rig.field.jacobian(rig.phase(), dfdx, dfdv, e);
    const Eigen::SparseMatrix<double> kx = to_eigen(dfdx), kv = to_eigen(dfdv);

    const auto expect_column = [&](std::span<double> values, size_t column,
                                   const Eigen::SparseMatrix<double>& k) {
      const double at = values[column], h = 1e-6;
      values[column] = at + h;
      const auto up = rig.forces();
      values[column] = at - h;
      const auto down = rig.forces();
      values[column] = at;
      for (size_t r = 0; r < up.size(); ++r) {
        if (rig.state.f64(Columns::inverse_mass)[r / 3] == 0) continue;
        const double slope = (up[r] - down[r]) / (2 * h);
        ASSERT_NEAR(k.coeff(static_cast<int>(r), static_cast<int>(column)), slope,
                    1e-5 * (1 + std::abs(slope)) + 2e-4)
            << "row " << r << " column " << column;
      }
    };
    const size_t stride = rig.x().size() > 300 ? 997 : 5;
    for (size_t c = 0; c < rig.x().size(); c += stride) {
      expect_column(rig.v(), c, kv);
      if (wind_speed == 0) expect_column(rig.x(), c, kx);
    }
    // Symmetric, as conjugate gradients need.
    EXPECT_LT((kx - Eigen::SparseMatrix<double>(kx.transpose())).norm(), 1e-12 * kx.norm());
    EXPECT_LE((kv - Eigen::SparseMatrix<double>(kv.transpose())).norm(), 1e-12 * kv.norm());
  }
}

// Springs and their damping push both ends equally: without gravity, air and viscous damping the sum of all
// forces and of all torques vanishes to rounding. Viscous damping is the control that breaks both.
TEST_P(Networks, InternalForcesConserveMomentum) {
  MassSpringDef def = GetParam()();
  def.internal_damping = 0.5;
  for (const double viscous : {0.0, 0.2}) {
    def.damping = viscous;
    Rig rig(def, {});
    for (size_t i = 0; i < rig.points(); ++i)
      rig.state.f64(Columns::inverse_mass)[i] = 1 / rig.field.masses()[i];
    rig.shake(0.02, 0.5);
    const auto f = rig.forces();
    Vec3 sum, torque;
    double size = 0;
    for (size_t i = 0; i < rig.points(); ++i) {
      sum += load3(f.data(), i);
      torque += cross(load3<double>(rig.x().data(), i), load3(f.data(), i));
      size += norm(load3(f.data(), i));
    }
    if (viscous == 0) {
      EXPECT_LT(norm(sum), 1e-12 * size);
      EXPECT_LT(norm(torque), 1e-12 * size);
    } else {
      EXPECT_GT(norm(sum), 1e-9 * size);
    }
  }
}

// Damping along springs removes energy from stretching and none from rotation.
TEST(MassSpringForces, InternalDampingDissipatesStretchingOnly) {
  MassSpringDef def = cloth();
  def.internal_damping = 0.7;
  def.stiffness = def.shear_stiffness = def.bending_stiffness = 1e-9;
  Rig rig(def, {});
  rig.shake(0.02, 0.5);
  const auto power = [&] {
    const auto f = rig.forces();
    double p = 0;
    for (size_t i = 0; i < f.size(); ++i) p += f[i] * rig.v()[i];
    return p;
  };
  EXPECT_LT(power(), -0.01);
  for (size_t i = 0; i < rig.points(); ++i) {
    const Vec3 x = load3<double>(rig.x().data(), i);
    store3(rig.v().data(), i, Vec3{1, 2, 3} + cross({0.3, -1, 2}, x));
  }
  EXPECT_NEAR(power(), 0, 1e-8);
}

TEST(MassSpringForces, CoincidentPointsStayFinite) {
  for (const double rest_scale : {0.0, 1.0}) {
    MassSpringDef def = cloth();
    def.rest_scale = rest_scale;
    def.internal_damping = 1;
    def.wind = Vec3{1, 0, 0};
    Rig rig(def);
    for (size_t i = 0; i < rig.points(); ++i) store3(rig.x().data(), i, Vec3{1, 2, 3});
    for (const double a : rig.acceleration()) ASSERT_TRUE(std::isfinite(a));
    BlockSparse dfdx, dfdv;
    rig.field.jacobian_pattern(rig.state, dfdx, dfdv);
    auto e = rig.evaluation();
    rig.field.jacobian(rig.phase(), dfdx, dfdv, e);
    for (const double k : dfdx.values()) ASSERT_TRUE(std::isfinite(k));
    for (const double k : dfdv.values()) ASSERT_TRUE(std::isfinite(k));
  }
}

TEST(MassSpringForces, PinnedPointsDoNotAccelerate) {
  MassSpringDef def = cloth();
  def.pinned = {"corners"};
  def.wind = Vec3{5, 0, 0};
  Rig rig(def);
  EXPECT_EQ(rig.field.network().pins, (std::vector<uint32_t>{0, 8, 99, 107}));
  const auto a = rig.acceleration();
  for (const uint32_t p : rig.field.network().pins) EXPECT_EQ(load3(a.data(), p), Vec3{});
  EXPECT_NE(load3(a.data(), 50), Vec3{});
}

// Pressure on a flat plate across the wind: rho/2 C A u^2; along it nothing.
TEST(MassSpringForces, WindPushesAPlate) {
  MassSpringDef def = cloth();  // 1 m^2 in the plane y = 0
  const auto total = [&](Vec3 wind) {
    def.wind = wind;
    Rig rig(def, {});
    Vec3 sum;
    const auto f = rig.forces();
    for (size_t i = 0; i < rig.points(); ++i) sum += load3(f.data(), i);
    return sum;
  };
  EXPECT_NEAR(total({0, 3, 0}).y, 0.5 * 1.2 * 1.2 * 9, 1e-10);
  EXPECT_NEAR(total({0, -3, 0}).y, -0.5 * 1.2 * 1.2 * 9, 1e-10);
  EXPECT_NEAR(norm(total({3, 0, 0})), 0, 1e-10);
}

TEST(MassSpringForces, ThreadsDoNotChangeABit) {
  MassSpringDef def = big_cloth();
  def.internal_damping = 0.1;
  def.wind = Vec3{2, 1, 0};
  std::vector<std::vector<double>> results;
  for (const int threads : {1, 2, 4}) {
    Rig rig(def, {0, -9.81, 0}, threads);
    rig.shake(0.005, 0.5);
    results.push_back(rig.acceleration());
    results.back().push_back(rig.potential());
    BlockSparse dfdx, dfdv;
    rig.field.jacobian_pattern(rig.state, dfdx, dfdv);
    auto e = rig.evaluation();
    rig.field.jacobian(rig.phase(), dfdx, dfdv, e);
    for (const double k : dfdx.values()) results.back().push_back(k);
    for (const double k : dfdv.values()) results.back().push_back(k);
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

// A long chain has omega_max = 2 sqrt(k/m); the bound must hold and be tight there.
TEST(MassSpringForces, StiffnessBoundsTheLargestFrequency) {
  MassSpringDef def;
  def.rope = RopeShape{.from = {0, 0, 0}, .to = {1, 0, 0}, .links = 50};
  def.stiffness = 400;
  def.mass = 0.25;
  const Rig rig(def);
  EXPECT_NEAR(rig.field.stiffness(rig.state)->omega, 2 * std::sqrt(400 / 0.25), 1e-9);
  for (MassSpringDef d : {cloth(), mesh(), own_springs(), hair()}) {
    Rig network(d);
    network.shake(0.02, 0);
    BlockSparse dfdx, dfdv;
    network.field.jacobian_pattern(network.state, dfdx, dfdv);
    auto e = network.evaluation();
    network.field.jacobian(network.phase(), dfdx, dfdv, e);
    Eigen::MatrixXd k = -to_eigen(dfdx).toDense();
    for (Eigen::Index r = 0; r < k.rows(); ++r) {
      for (Eigen::Index c = 0; c < k.cols(); ++c) {
        const auto w = network.state.f64(Columns::inverse_mass);
        k(r, c) *= std::sqrt(w[static_cast<size_t>(r / 3)] * w[static_cast<size_t>(c / 3)]);
      }
    }
    const double exact =
        std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k).eigenvalues().maxCoeff());
    const double bound = network.field.stiffness(network.state)->omega;
    EXPECT_GE(bound, exact * (1 - 1e-12));
    EXPECT_LE(bound, exact * 1.6);
  }
}

TEST(MassSpringShapes, SlackRopeHasItsLengthAndEnds) {
  MassSpringDef def;
  def.rope = RopeShape{.from = {0, 0, 0}, .to = {1, 0.3, 0}, .links = 40, .length = 1.5};
  const Rig rig(def);
  const auto& x = rig.field.network().x;
  ASSERT_EQ(x.size(), 41u);
  EXPECT_LT(norm(x.back() - Vec3{1, 0.3, 0}), 1e-12);
  for (size_t s = 0; s < 40; ++s) {
    EXPECT_NEAR(norm(x[s + 1] - x[s]), 1.5 / 40, 1.5 / 40 * 0.02);  // chords of a curve are a little shorter
    EXPECT_DOUBLE_EQ(rig.field.schedule().rest[s], 1.5 / 40);
  }
  EXPECT_LT(x[20].y, -0.2);
}

TEST(MassSpringShapes, CountsAgreeWithWhatIsBuilt) {
  for (const MassSpringDef& d : {hanging_rope(), hair(), cloth(), mesh(), own_springs()}) {
    const Rig rig(d);
    const MassSpringCounts counts = mass_spring_counts(d);
    EXPECT_EQ(counts.points, static_cast<double>(rig.field.network().x.size()));
    EXPECT_GE(counts.springs, static_cast<double>(rig.field.network().springs.size()));
    EXPECT_LE(counts.springs, 2.5 * static_cast<double>(rig.field.network().springs.size()));
  }
}

TEST(MassSpringShapes, DensityGivesTheWholeItsMass) {
  for (MassSpringDef d : {hanging_rope(), cloth(), mesh()}) {
    d.density = 2;
    const Rig rig(d);
    double total = 0;
    for (const double m : rig.field.masses()) total += m;
    const double size = d.rope ? norm(d.rope->to - d.rope->from) : d.cloth_grid ? 1.0 : 0.0;
    if (size > 0) {
      EXPECT_NEAR(total, 2 * size, 1e-12);
    }
    EXPECT_GT(total, 0);
  }
}

// f = -dV/dx - dR/dv with every force there is. Differences over 1e-6 of values of 10 J leave 1e-9; control:
// without R the forces are off by far.
TEST(MassSpringForces, PotentialAndDissipationTogetherGiveTheWholeForce) {
  for (MassSpringDef d : {cloth(), hanging_rope()}) {
    d.damping = 0.02, d.internal_damping = 0.3, d.wind = Vec3{1, 0.5, 3}, d.gust = 0.5;
    Rig rig(d);
    rig.shake(0.02, 1);
    for (const auto c : {Columns::push_row, Columns::push_force, Columns::push_remaining})
      rig.state.resize(c, 1);
    rig.state.span<uint32_t>(Columns::push_row)[0] = 3;
    store3(rig.state.f64(Columns::push_force).data(), 0, Vec3{0.1, 0.2, -0.3});
    const auto f = rig.forces();
    const auto e = rig.evaluation();
    const auto slope = [&](double& at, auto value) {
      const double h = 1e-6, before = at;
      at = before + h;
      const double up = value();
      at = before - h;
      const double down = value();
      at = before;
      return (up - down) / (2 * h);
    };
    double missing = 0;
    for (size_t k = 0; k < f.size(); k += 7) {
      const double gradient = slope(rig.x()[k], [&] { return rig.potential(); });
      const double drag = slope(rig.v()[k], [&] {
        auto scratch = e;
        return rig.field.dissipation(rig.phase(), scratch).value();
      });
      EXPECT_NEAR(f[k], -gradient - drag, 1e-6) << k;
      missing = std::max(missing, std::abs(f[k] + gradient));
    }
    EXPECT_GT(missing, 1e-2);
  }
}

}  // namespace
}  // namespace truestep
