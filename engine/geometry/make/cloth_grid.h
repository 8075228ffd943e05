// A rectangular cloth: points in rows, triangles, pairs along its directions, and the rods that give it the
// stiffness of an isotropic plate or membrane.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

enum class ShearSprings : uint8_t { both, one, none };

struct ClothGridShape {
  Vec3 origin{}, edge_u{1, 0, 0}, edge_v{0, 0, 1};  // m
  int nx = 20, ny = 20;                             // points along u and v
  ShearSprings shear = ShearSprings::both;
};

struct ClothGrid {
  std::vector<Vec3> x;        ///< m; point (i, j) is row j nx + i
  std::vector<double> share;  ///< m^2, the area that a point represents
  /// Squares cut along alternating diagonals, so that the cloth has no preferred one.
  std::vector<std::array<uint32_t, 3>> triangles;
};
ClothGrid make_cloth_grid(const ClothGridShape& shape);

/// Points (i, j) and (i + di, j + dj), row by row. dj >= 0.
std::vector<std::array<uint32_t, 2>> grid_pairs(const ClothGridShape& shape, int di, int dj);
/// Rows of "corners", "corner_00" ..., "edge_u0" ..., "border"; empty for any other name.
std::vector<uint32_t> named_grid_points(const ClothGridShape& shape, std::string_view name);

/// Weights of rods along the sides and the diagonals of a cell, of lengths u, v and d = sqrt(u^2 + v^2),
/// whose energies per area add up to that of an isotropic material with Poisson ratio 1/3: of bending,
///   D/2 (kuu^2 + kvv^2 + 2 nu kuu kvv + 2 (1 - nu) kuv^2),
/// and of stretching with strains in place of curvatures. A diagonal's share of kuu is c^2 and of kvv s^2,
/// c = u/d, s = v/d; comparing gives
///   1 / (6 c^2 s^2) of a diagonal,   1 - c^2 / (3 s^2) along u,   1 - s^2 / (3 c^2) along v.
struct PlateWeights {
  double u, v, diagonal;
  double u2, v2;  ///< squared lengths, m^2
};
PlateWeights plate_weights(const ClothGridShape& shape);
/// Why the weights cannot be used (angles that are not right, cells too long), or null.
const char* plate_fault(const ClothGridShape& shape);

/// Three points in line; a curvature k (1/m) there has the energy 1/2 D weight |k|^2 times the share of the
/// middle point.
struct PlateRod {
  std::array<uint32_t, 3> points;
  double weight;
  double length2;  ///< squared length of each of the two links, m^2
};
std::vector<PlateRod> plate_rods(const ClothGridShape& shape);

}  // namespace truestep
