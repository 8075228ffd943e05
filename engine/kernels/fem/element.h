// Finite elements of first and second order: shape functions N_a and their gradients by the reference
// coordinates at the points of a quadrature rule, faces, lumped mass fractions (Hughes 1987, chapters 3 and
// 7). Corners are numbered as in VTK; further nodes lie in the middle of edges, then faces, then the cell:
// each is the mean of the corners it lies between.
//   simplices  tri3 tet4 (1 point), tri6 (3 points), tet10 (4 points)
//   products   line2 quad4 hex8 (2 points a direction), line3 quad9 hex27 (3)
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep::fem {

struct Element {
  struct Face {
    const Element* kind;
    std::vector<uint32_t> nodes;  ///< of the element, in the face's own order, anticlockwise from outside
  };

  std::string_view name;
  uint32_t dimension = 3, corners = 4;
  bool simplex = true;
  std::vector<Vec3> nodes;                      ///< reference coordinates
  std::vector<std::vector<uint32_t>> supports;  ///< corners of which a node is the mean
  std::vector<Vec3> points;                     ///< quadrature points
  std::vector<double> weights;
  std::vector<double> shape;   ///< N_a at [point * nodes + a]
  std::vector<Vec3> gradient;  ///< dN_a / d(xi, eta, zeta), the same
  std::vector<Face> faces;     ///< edges of a plane element
  std::vector<double> lump;    ///< share of a straight-sided element's mass: N_a^2 scaled to 1 (Hinton,
                               ///< Rock, Zienkiewicz 1976)
  std::vector<std::vector<uint32_t>> triangles;  ///< of a plane element, for drawing

  size_t size() const { return nodes.size(); }
};

enum class ElementKind : uint8_t { tri3, tri6, quad4, quad9, tet4, tet10, hex8, hex27, line2, line3 };
const Element& element_of(ElementKind kind);

/// N_a and gradients at any reference point, for probes and tests; both as long as the nodes.
void shape_at(const Element& element, const Vec3& xi, std::vector<double>& n, std::vector<Vec3>& gradient);

}  // namespace truestep::fem
