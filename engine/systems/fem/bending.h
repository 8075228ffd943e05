// Assembled bending of a shell (kernels/fem/bending.h): a constant matrix over its nodes, the same for x, y
// and z, the constant vector of edges with a clamped direction, and edges that are bent at rest.
//   E / D = 1/2 x . Q x - c . x + sum over points of bent edges w j (M - eta / h J) . n(x) + E_0,  0 at rest
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/kernels/fem/bending.h"
#include "engine/math/block_sparse.h"
#include "engine/systems/fem/mesh.h"

namespace truestep::fem {

/// Two elements folded onto each other along an edge, where a shell has no direction; nothing if there are
/// none.
std::optional<std::array<size_t, 2>> first_fold(const Mesh& mesh);

class Bending {
 public:
  Bending() = default;
  /// `clamped`: nodes whose edges along the rim keep their direction.
  Bending(const Mesh& mesh, const std::vector<uint8_t>& clamped, double poisson);

  bool empty() const { return row_begin_.empty(); }
  void add_pairs(std::vector<BlockSparse::Pair>& pairs) const;
  void find_slots(const BlockSparse& pattern);

  /// J, at flexural rigidity D (N m).
  double energy(double rigidity, std::span<const double> x, const ThreadArena& arena) const;
  /// Adds -dE/dx to f.
  void add_forces(double rigidity, std::span<const double> x, std::span<double> f,
                  const ThreadArena& arena) const;
  /// Adds -d2E/dx2 to dfdx.
  void add_stiffness(double rigidity, std::span<const double> x, BentSlope kind, BlockSparse& dfdx,
                     const ThreadArena& arena) const;

 private:
  /// A quadrature point of an edge that is bent at rest.
  struct BentPoint {
    std::vector<uint32_t> nodes;
    std::vector<std::array<double, 3>> sums;  ///< coefficients of every node in L, t, c
    double weight, penalty;                   ///< w j; eta j / h
    std::vector<BlockSparse::Slot> slots;     ///< nodes x nodes
  };
  std::array<Vec3, 3> sums_of(const BentPoint& p, std::span<const double> x) const;
  Vec3 row(std::span<const double> x, size_t i) const;
  void add_edge(const Mesh& mesh, const Facet& one, const Facet* two, double poisson);

  std::vector<std::pair<BlockSparse::Pair, double>> entries_;  // during assembly
  std::vector<uint32_t> row_begin_, columns_;
  std::vector<double> values_;
  std::vector<BlockSparse::Slot> slots_;
  std::vector<Vec3> constant_;  // c
  std::vector<BentPoint> bent_;
  double at_rest_ = 0;  // J / (N m)
};

}  // namespace truestep::fem
