// The node blocks that precondition the implicit step: 3 x 3, symmetric positive definite,
//   m + sum_p V_p ((lambda + mu) b b^T + mu |b|^2),
// with b = h times the gradient of the node's weight at the particle: the node's diagonal block of the
// Hessian of linear elasticity.
#pragma once
#include "engine/systems/mpm/transfer.h"

namespace truestep::mpm {

/// Entries of an inverse block: xx, xy, xz, yy, yz, zz.
inline constexpr size_t kSix = 6;

/// The entries that one pass adds up: xx, yy, zz; or xy, xz, yz.
enum class Entries : unsigned char { diagonal, others };

/// One particle's part of the blocks of its nodes: the diagonals (xx, yy, zz), or the rest (xy, xz, yz).
template <int D, int Nodes, int Width, int Row>
void add_node_blocks(const Stencils<D, Nodes, double>& at, int lane, double per_second, double both,
                     double own, Entries entries, double* tile) {
  for (int i = 0; i < Nodes; ++i) {
    for (int j = 0; j < Nodes; ++j) {
      for (int k = 0; k < (D == 3 ? Nodes : 1); ++k) {
        const double wx = at.w[0][i][lane], wy = at.w[1][j][lane], wz = D == 3 ? at.w[D - 1][k][lane] : 1;
        const double b[3] = {per_second * at.wd[0][i][lane] * wy * wz,
                             per_second * wx * at.wd[1][j][lane] * wz,
                             D == 3 ? per_second * wx * wy * at.wd[D - 1][k][lane] : 0};
        const int row = D == 3 ? (i * Width + j) * Row + k : i * Row + j;
        double* node = tile + 4 * (static_cast<ptrdiff_t>(at.first[lane]) + row);
        if (entries == Entries::diagonal) {
          const double round = own * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
          for (int a = 0; a < D; ++a) node[a + 1] += both * b[a] * b[a] + round;
        } else {
          node[1] += both * b[0] * b[1], node[2] += both * b[0] * b[2], node[3] += both * b[1] * b[2];
        }
      }
    }
  }
}

/// The inverse of the node's mass plus a block; zero if there is no mass.
template <int D>
void inverse_of_block(double mass, const double* diagonal, const double* others, double* to) {
  // Scaled by the size, so that the determinant of a node with almost no mass does not underflow.
  const double size = mass + diagonal[0] + diagonal[1] + diagonal[2], unit = size > 0 ? 1 / size : 0;
  const double xx = (mass + diagonal[0]) * unit, yy = (mass + diagonal[1]) * unit;
  const double zz = D == 3 ? (mass + diagonal[2]) * unit : 1;
  const double xy = others[0] * unit, xz = others[1] * unit, yz = others[2] * unit;
  const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
  const double over = mass > 0 ? unit / (xx * a + xy * b + xz * c) : 0;
  to[0] = a * over, to[1] = b * over, to[2] = c * over;
  to[3] = (xx * zz - xz * xz) * over, to[4] = (xy * xz - xx * yz) * over, to[5] = (xx * yy - xy * xy) * over;
}

/// to = inverse block times from; vectors are the last three of four numbers.
inline void apply_block(const double* k, const double* from, double* to) {
  const double x = from[1], y = from[2], z = from[3];
  to[0] = 0, to[1] = k[0] * x + k[1] * y + k[2] * z;
  to[2] = k[1] * x + k[3] * y + k[4] * z, to[3] = k[2] * x + k[4] * y + k[5] * z;
}

}  // namespace truestep::mpm
