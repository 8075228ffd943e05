// L u = div(c grad u) on a lattice by finite differences, with the homogeneous part of its sides; rows of
// nodes with given values are 0. Second order: differences over the faces between nodes, coefficients at the
// faces' centres, half cells at sides (conservative, self-adjoint in the nodes' volumes). Fourth order:
// constant coefficients, five points along an axis, odd and even reflection at Dirichlet and Neumann sides
// (also self-adjoint, and diagonal in sines and cosines); the contributions of given values and sources to
// the reflected nodes are part of the forcing (forcing.h).
#pragma once
#include <vector>

#include "engine/base/parallel.h"
#include "engine/core/equations/right_hand_side.h"
#include "engine/lattice/lattice.h"

namespace truestep::lattice {

/// c at the nodes and at the centres of the faces, one array per axis with as many elements as nodes (faces
/// beyond the last node of a non-periodic axis are not read); all empty: constant.
struct Coefficient {
  double constant = 1;
  std::vector<double> nodes;
  std::array<std::vector<double>, 3> faces;
  bool variable() const { return !nodes.empty(); }
  double at(size_t node) const { return variable() ? nodes[node] : constant; }
};

class Diffusion {
 public:
  Diffusion() = default;
  /// `order` is 2, or 4 if the coefficient is constant and no side is a Robin side.
  Diffusion(const Lattice& lattice, int order, Coefficient c);

  const Lattice& lattice() const { return lattice_; }
  const Coefficient& coefficient() const { return c_; }
  Coefficient& coefficient() { return c_; }
  int order() const { return order_; }

  /// out = identity u + step L u; the arrays do not overlap.
  void apply(const double* u, double* out, double identity, double step, const ThreadArena& arena) const;
  /// u += step L u without a second array: rows are buffered in `waiting` until no other row needs the values
  /// that they replace. The same bits as `apply`.
  void step_in_place(double* u, double step, std::vector<double>& waiting) const;
  /// x += h/2 v, v += h L x, x += h/2 v in one sweep over the rows; `row` is scratch. The same bits as one
  /// array after the other.
  void leapfrog_in_place(double* x, double* v, double h, std::vector<double>& row) const;
  /// A bound of the largest |eigenvalue| (Gershgorin), exact to a few percent for constant coefficients.
  double spectral_radius() const;
  /// -1/2 u L u, weighted by the nodes' volumes, for homogeneous sides. `sums` is scratch that grows once.
  double potential(const double* u, std::vector<double>& sums) const;

  /// Sparsity pattern and values of L in compressed columns.
  struct Matrix {
    std::vector<int32_t> column_start, rows;
    std::vector<double> values;
    MatrixShape shape() const { return {MatrixShape::Kind::sparse, 0, 0, column_start, rows}; }
  };
  Matrix matrix() const;

  /// f(neighbour, weight) for the entries of a node's row, including the node itself; a neighbour may occur
  /// twice.
  template <class F>
  void entries(const std::array<size_t, 3>& p, F&& f) const;

 private:
  /// Weights of the five nodes around a node along an axis, in units of c / spacing^2.
  struct Taps {
    std::array<uint32_t, 5> index;
    std::array<double, 5> weight;
  };
  /// Row (j, k) of identity u + step L u.
  void apply_row(const double* u, double* row, double identity, double step, size_t j, size_t k) const;
  /// Element i of it, by its entries.
  void apply_end(const double* u, double* row, double identity, double step,
                 const std::array<size_t, 3>& p) const;

  Lattice lattice_;
  int order_ = 2;
  Coefficient c_;
  std::array<std::vector<Taps>, 3> taps_;
};

template <class F>
void Diffusion::entries(const std::array<size_t, 3>& p, F&& f) const {
  if (lattice_.fixed(p)) return;
  const size_t node = p[0] + lattice_.stride(1) * p[1] + lattice_.stride(2) * p[2];
  for (size_t a = 0; a < lattice_.dimensions; ++a) {
    const Axis& axis = lattice_.axes[a];
    const size_t stride = lattice_.stride(a), line = node - p[a] * stride, i = p[a];
    const double scale = 1 / (axis.spacing * axis.spacing);
    if (!c_.variable()) {
      const Taps& t = taps_[a][i];
      for (size_t m = 0; m < 5; ++m) {
        if (t.weight[m] != 0) f(line + t.index[m] * stride, t.weight[m] * scale * c_.constant);
      }
      continue;
    }
    const double low = scale * c_.faces[a][line + axis.face_before(i) * stride];
    const double high = scale * c_.faces[a][line + axis.face_after(i) * stride];
    double centre = -(low + high);
    for (size_t s = 0; s < 2; ++s) {
      if (i == (s == 0 ? 0 : axis.cells) && axis.sides[s].kind == SideKind::robin) {
        centre -= 2 / axis.spacing * axis.sides[s].transfer * c_.nodes[node];
      }
    }
    f(line + axis.before(i) * stride, low);
    f(node, centre);
    f(line + axis.after(i) * stride, high);
  }
}

}  // namespace truestep::lattice
