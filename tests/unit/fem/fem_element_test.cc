// Shape functions and rules of finite elements.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/kernels/fem/element.h"

namespace truestep::fem {
namespace {

using enum ElementKind;
constexpr ElementKind kKinds[] = {tri3, tri6, quad4, quad9, tet4, tet10, hex8, hex27, line2, line3};

TEST(FemElement, ShapesAreOneAtTheirNodeAndSumToOne) {
  for (const ElementKind kind : kKinds) {
    const Element& e = element_of(kind);
    std::vector<double> n;
    std::vector<Vec3> g;
    for (size_t a = 0; a < e.size(); ++a) {
      shape_at(e, e.nodes[a], n, g);
      for (size_t b = 0; b < e.size(); ++b) EXPECT_NEAR(n[b], a == b ? 1 : 0, 1e-14) << e.name;
    }
    shape_at(e, {0.21, e.dimension > 1 ? 0.13 : 0, e.dimension > 2 ? 0.34 : 0}, n, g);
    double sum = 0;
    Vec3 slope, place;
    for (size_t a = 0; a < e.size(); ++a) sum += n[a], slope += g[a], place += n[a] * e.nodes[a];
    EXPECT_NEAR(sum, 1, 1e-14) << e.name;
    EXPECT_NEAR(norm(slope), 0, 1e-13) << e.name;
    EXPECT_NEAR(place.x, 0.21, 1e-14) << e.name;
  }
}

TEST(FemElement, GradientsAreDifferences) {
  constexpr double kStep = 1e-6;
  for (const ElementKind kind : kKinds) {
    const Element& e = element_of(kind);
    const Vec3 at{0.2, e.dimension > 1 ? 0.3 : 0, e.dimension > 2 ? 0.1 : 0};
    std::vector<double> n, up, down;
    std::vector<Vec3> g, ignored;
    shape_at(e, at, n, g);
    for (uint32_t d = 0; d < e.dimension; ++d) {
      const Vec3 step{d == 0 ? kStep : 0, d == 1 ? kStep : 0, d == 2 ? kStep : 0};
      shape_at(e, at + step, up, ignored);
      shape_at(e, at - step, down, ignored);
      for (size_t a = 0; a < e.size(); ++a) {
        const double along = d == 0 ? g[a].x : d == 1 ? g[a].y : g[a].z;
        EXPECT_NEAR((up[a] - down[a]) / (2 * kStep), along, 1e-9) << e.name;
      }
    }
  }
}

// The stiffness of a straight-sided second-order element is a polynomial of degree 2 (simplices), or 4 in
// each direction (products), which its rule must integrate.
TEST(FemElement, RulesIntegrateWhatStiffnessNeeds) {
  for (const ElementKind kind : kKinds) {
    const Element& e = element_of(kind);
    const bool second = e.size() > e.corners;
    double volume = 0, xx = 0, x4 = 0;
    for (size_t q = 0; q < e.points.size(); ++q) {
      const double x = e.points[q].x;
      volume += e.weights[q], xx += e.weights[q] * x * x, x4 += e.weights[q] * x * x * x * x;
    }
    const double whole = e.simplex ? (e.dimension == 2 ? 1. / 2 : 1. / 6) : std::exp2(e.dimension);
    EXPECT_NEAR(volume, whole, 1e-14) << e.name;
    const double exact = e.simplex ? (e.dimension == 2 ? 1. / 12 : 1. / 60) : whole / 3;
    if (second || !e.simplex) {
      EXPECT_NEAR(xx, exact, 1e-14) << e.name;
    } else {
      EXPECT_GT(std::abs(xx - exact), 1e-3) << e.name;
    }
    if (second && !e.simplex) {
      EXPECT_NEAR(x4, whole / 5, 1e-14) << e.name;
    }
    double mass = 0;
    for (const double s : e.lump) {
      EXPECT_GT(s, 0) << e.name;
      mass += s;
    }
    EXPECT_NEAR(mass, 1, 1e-14) << e.name;
  }
}

TEST(FemElement, FacesLookOutwardAndHaveTheirNodes) {
  for (const ElementKind kind : {tri3, tri6, quad4, quad9, tet4, tet10, hex8, hex27}) {
    const Element& e = element_of(kind);
    Vec3 centre;
    for (uint32_t c = 0; c < e.corners; ++c) centre += e.nodes[c] / static_cast<double>(e.corners);
    for (const auto& face : e.faces) {
      ASSERT_EQ(face.nodes.size(), face.kind->size()) << e.name;
      for (size_t q = 0; q < face.kind->points.size(); ++q) {
        Vec3 at, along, across;
        for (size_t a = 0; a < face.nodes.size(); ++a) {
          const size_t k = q * face.nodes.size() + a;
          at += face.kind->shape[k] * e.nodes[face.nodes[a]];
          along += face.kind->gradient[k].x * e.nodes[face.nodes[a]];
          across += face.kind->gradient[k].y * e.nodes[face.nodes[a]];
        }
        if (e.dimension == 2) across = {0, 0, 1};
        EXPECT_GT(dot(cross(along, across), at - centre), 0) << e.name;
      }
    }
  }
}

}  // namespace
}  // namespace truestep::fem
