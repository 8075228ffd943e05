// A box of tetrahedra: every cell of a lattice is cut into five, alternately one way and the other, so that
// neighbours fit and no diagonal is preferred.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

struct SoftBlockShape {
  Vec3 origin{}, size{1, 1, 1};               // m: the smallest corner, the lengths of the edges
  int cells_x = 4, cells_y = 4, cells_z = 4;  // along each edge
};

struct SoftBlock {
  std::vector<Vec3> x;                              ///< m; x fastest, then y, then z
  std::vector<double> share;                        ///< m^3, the volume that a point represents
  std::vector<std::array<uint32_t, 4>> tetrahedra;  ///< of positive volume
  std::vector<std::array<uint32_t, 3>> triangles;   ///< the surface, anticlockwise from outside
  std::vector<std::array<uint32_t, 2>> edges;       ///< of the tetrahedra, each once, ascending
};
SoftBlock make_soft_block(const SoftBlockShape& shape);

}  // namespace truestep
