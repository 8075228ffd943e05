#include "engine/math/solvers/symbolic_fill.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include "engine/base/interrupt.h"

namespace truestep {

FactorWork symbolic_factor_work(const ColumnPattern& a) {
  const auto n = static_cast<int>(a.columns());
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  std::vector<Eigen::Triplet<double, int>> entries;
  for (int j = 0; j < n; ++j) {
    entries.emplace_back(j, j, 1.0);
    for (int32_t k = a.start[static_cast<size_t>(j)]; k < a.start[static_cast<size_t>(j) + 1]; ++k) {
      const int i = a.rows[static_cast<size_t>(k)];
      entries.emplace_back(i, j, 1.0), entries.emplace_back(j, i, 1.0);
    }
  }
  Matrix both(n, n);
  both.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(both.selfadjointView<Eigen::Upper>(), order);
  // indices()[new] = old.
  std::vector<int> place(static_cast<size_t>(n));
  for (int k = 0; k < n; ++k) place[static_cast<size_t>(order.indices()[k])] = k;

  std::vector<int> parent(static_cast<size_t>(n), -1), seen(static_cast<size_t>(n), -1);
  std::vector<double> column(static_cast<size_t>(n), 0);
  for (int k = 0; k < n; ++k) {
    if (k % 256 == 0) interruption_point();
    seen[static_cast<size_t>(k)] = k;
    for (Matrix::InnerIterator it(both, order.indices()[k]); it; ++it) {
      // From every earlier unknown of row k up the tree, until a node already visited.
      for (int i = place[static_cast<size_t>(it.row())]; i < k && seen[static_cast<size_t>(i)] != k;
           i = parent[static_cast<size_t>(i)]) {
        if (parent[static_cast<size_t>(i)] == -1) parent[static_cast<size_t>(i)] = k;
        seen[static_cast<size_t>(i)] = k;
        column[static_cast<size_t>(i)] += 1;
      }
    }
  }
  FactorWork out;
  for (const double c : column) out.factor += c * c + c, out.solve += 2 * c + 1;
  return out;
}

}  // namespace truestep
