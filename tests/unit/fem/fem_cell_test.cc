// One element: forces against differences of the energy, stiffness against differences of the forces, for
// every kind, with pointwise and mean volume, in space, plane strain and plane stress.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <random>

#include "engine/kernels/fem/cell.h"
#include "engine/kernels/fem/element.h"

namespace truestep::fem {
namespace {

// An element with curved sides, and the displaced positions of its nodes.
struct One {
  std::vector<Vec3> gradients, rest, x;
  std::vector<double> weights;
  CellRule rule;

  One(ElementKind kind, Across across, bool mean, double noise) : rule{} {
    const Element& e = element_of(kind);
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> spread(-1, 1);
    const auto shaken = [&](const Vec3& p, double by) {
      return p + Vec3{by * spread(engine), by * spread(engine), e.dimension == 3 ? by * spread(engine) : 0};
    };
    for (const Vec3& p : e.nodes) rest.push_back(shaken(p, 0.04));
    for (size_t q = 0; q < e.points.size(); ++q) {
      Mat3 j;
      for (size_t a = 0; a < e.size(); ++a) {
        const Vec3 g = e.gradient[q * e.size() + a];
        j = j + Mat3{{rest[a].x * g.x, rest[a].x * g.y, rest[a].x * g.z, rest[a].y * g.x, rest[a].y * g.y,
                      rest[a].y * g.z, rest[a].z * g.x, rest[a].z * g.y, rest[a].z * g.z}};
      }
      if (e.dimension == 2) j(2, 2) = 1;
      weights.push_back(e.weights[q] * determinant(j));
      for (size_t a = 0; a < e.size(); ++a) {
        gradients.push_back(transposed(inverse(j)) * e.gradient[q * e.size() + a]);
      }
    }
    for (const Vec3& p : rest) x.push_back(shaken(1.1 * p, noise));
    rule = {e.size(), e.points.size(), gradients.data(), weights.data(), across, mean};
  }
};

std::vector<std::pair<ElementKind, Across>> all_kinds() {
  using enum ElementKind;
  std::vector<std::pair<ElementKind, Across>> out;
  for (const auto kind : {tet4, tet10, hex8, hex27}) out.emplace_back(kind, Across::space);
  for (const auto kind : {tri3, tri6, quad4, quad9}) {
    out.emplace_back(kind, Across::plane_strain), out.emplace_back(kind, Across::plane_stress);
  }
  return out;
}

double component(const Vec3& v, size_t c) {
  return c == 0 ? v.x : c == 1 ? v.y : v.z;
}
void move(Vec3& v, size_t c, double by) {
  (c == 0 ? v.x : c == 1 ? v.y : v.z) += by;
}

// Steps of 1e-6 in numbers of order 1 to 100: 1e-9 from rounding. A wrong term is of order 1.
TEST(FemCell, ForcesAndStiffnessAreDerivatives) {
  constexpr double kStep = 1e-6;
  for (const auto& [kind, across] : all_kinds()) {
    const size_t axes = across == Across::space ? 3 : 2;
    for (const Law law : {Law::linear, Law::corotated, Law::neo_hookean, Law::mooney_rivlin}) {
      for (const bool mean : {false, true}) {
        if (mean && across == Across::plane_stress) continue;
        One one(kind, across, mean, 0.05);
        const Material m = material_of(law, 2, 0.3, law == Law::mooney_rivlin ? 0.2 : 0);
        const size_t n = one.rule.nodes;
        std::vector<Vec3> f(n), up(n), down(n);
        cell_forces(m, one.rule, one.x.data(), f.data());
        std::vector<double> k(9 * n * n);
        cell_stiffness(m, one.rule, one.x.data(), Definite::no, k.data());
        for (size_t b = 0; b < n; b += 1 + n / 5) {
          for (size_t c = 0; c < axes; ++c) {
            std::fill(up.begin(), up.end(), Vec3{}), std::fill(down.begin(), down.end(), Vec3{});
            move(one.x[b], c, kStep);
            const double high = cell_forces(m, one.rule, one.x.data(), up.data());
            move(one.x[b], c, -2 * kStep);
            const double low = cell_forces(m, one.rule, one.x.data(), down.data());
            move(one.x[b], c, kStep);
            EXPECT_NEAR(-(high - low) / (2 * kStep), component(f[b], c), 1e-7) << element_of(kind).name;
            for (size_t a = 0; a < n; ++a) {
              for (size_t r = 0; r < axes; ++r) {
                EXPECT_NEAR(-(component(up[a], r) - component(down[a], r)) / (2 * kStep),
                            k[9 * (a * n + b) + 3 * c + r], 1e-6)
                    << element_of(kind).name << ' ' << static_cast<int>(law) << ' ' << mean;
              }
            }
          }
        }
      }
    }
  }
}

TEST(FemCell, AFreeElementFeelsNoForceAsAWholeAndNoTorque) {
  for (const auto& [kind, across] : all_kinds()) {
    One one(kind, across, false, 0.1);
    std::vector<Vec3> f(one.rule.nodes);
    cell_forces(material_of(Law::neo_hookean, 1, 0.3), one.rule, one.x.data(), f.data());
    Vec3 sum, torque;
    double size = 0;
    for (size_t a = 0; a < f.size(); ++a) {
      sum += f[a], torque += cross(one.x[a], f[a]), size += norm(f[a]);
    }
    EXPECT_LT(norm(sum), 1e-14 * size);
    EXPECT_LT(norm(torque), 1e-13 * size);
    // The control: a linear material mistakes a rotated state for strain.
    std::fill(f.begin(), f.end(), Vec3{});
    cell_forces(material_of(Law::linear, 1, 0.3), one.rule, one.x.data(), f.data());
    torque = {};
    for (size_t a = 0; a < f.size(); ++a) torque += cross(one.x[a], f[a]);
    EXPECT_GT(norm(torque), 1e-6 * size);
  }
}

// Under tension every stiffness is definite: the one from principal axes equals that from dP/dF. The bound is
// rounding, of numbers of order 10. The control is compressed, where negative eigenvalues are removed.
TEST(FemCell, DefiniteStiffnessIsTheStiffnessWhereThatIsDefinite) {
  for (const auto& [kind, across] : all_kinds()) {
    for (const Law law : {Law::corotated, Law::st_venant_kirchhoff, Law::neo_hookean, Law::stable_neo_hookean,
                          Law::mooney_rivlin}) {
      for (const bool mean : {false, true}) {
        if (mean && across == Across::plane_stress) continue;
        // Across the plane, and without its own U'', it is not definite.
        if (mean && across == Across::plane_strain && law == Law::stable_neo_hookean) continue;
        const One one(kind, across, mean, 0);
        const Material m = material_of(law, 2, 0.3, law == Law::mooney_rivlin ? 0.1 : 0);
        const size_t n = one.rule.nodes;
        const auto apart = [&](double scale) {
          std::vector<Vec3> x = one.rest;
          for (Vec3& p : x) p = scale * Vec3{1.01 * p.x + 0.02 * p.y, p.y - 0.01 * p.x, 1.02 * p.z};
          std::vector<double> k(9 * n * n), definite(9 * n * n);
          cell_stiffness(m, one.rule, x.data(), Definite::no, k.data());
          cell_stiffness(m, one.rule, x.data(), Definite::yes, definite.data());
          double worst = 0;
          for (size_t i = 0; i < k.size(); ++i) worst = std::max(worst, std::abs(k[i] - definite[i]));
          return worst;
        };
        EXPECT_LT(apart(1.05), 1e-12) << element_of(kind).name << ' ' << static_cast<int>(law) << ' ' << mean;
        EXPECT_GT(apart(0.5), 1e-3) << element_of(kind).name << ' ' << static_cast<int>(law) << ' ' << mean;
      }
    }
  }
}

TEST(FemCell, DefiniteStiffnessHasNoNegativeEigenvalue) {
  int indefinite = 0;
  for (const auto& [kind, across] : all_kinds()) {
    for (const bool mean : {false, true}) {
      if (mean && across == Across::plane_stress) continue;
      One one(kind, across, mean, 0.1);
      for (Vec3& x : one.x) x.y *= 0.3;
      const auto n = static_cast<Eigen::Index>(3 * one.rule.nodes);
      const auto lowest = [&](Definite definite) {
        std::vector<double> k(static_cast<size_t>(n * n));
        cell_stiffness(material_of(Law::stable_neo_hookean, 1, 0.4), one.rule, one.x.data(), definite,
                       k.data());
        Eigen::MatrixXd whole(n, n);
        for (Eigen::Index i = 0; i < n; ++i) {
          for (Eigen::Index j = 0; j < n; ++j) {
            const auto block = static_cast<size_t>((i / 3) * (n / 3) + j / 3);
            whole(i, j) = k[9 * block + static_cast<size_t>(3 * (j % 3) + i % 3)];
          }
        }
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> e(whole);
        return e.eigenvalues()[0] / e.eigenvalues()[n - 1];
      };
      indefinite += lowest(Definite::no) < -1e-3;
      EXPECT_GT(lowest(Definite::yes), -1e-12) << element_of(kind).name << ' ' << mean;
    }
  }
  EXPECT_GT(indefinite, 5);
}

}  // namespace
}  // namespace truestep::fem
