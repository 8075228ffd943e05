// The implicit substep: the node velocities v that minimise
//   E(v) = sum_i m_i |v_i - v*_i|^2 / 2 + sum_p V_p psi((1 + h C_p(v)) F_p),
// with v* the velocities after gravity and forces: backward Euler for the elastic energy (Gast, Schroeder,
// Stomakhin, Jiang, Teran 2015). Newton's method with the positive part of the stiffness
// (kernels/mpm/stiffness.h), each direction by matrix-free conjugate gradients: a direction is gathered by
// the particles, changes their stress and is scattered back; preconditioned by every node's own block for
// small strain. Each step is shortened until E falls. What boundaries hold is found between solves
// (held_nodes.h).
#pragma once
#include <span>

#include "engine/kernels/mpm/stiffness.h"
#include "engine/systems/mpm/solvers/held_nodes.h"
#include "engine/systems/mpm/solvers/node_blocks.h"

namespace truestep::mpm {

template <int D, int Nodes>
class Implicit {
  using G = Grid<D, Nodes, double>;
  using W = Wide<double>;
  using L = Layout<D>;
  using M = Square<D, double>;
  using Vector = Aligned<double>;

 public:
  struct Report {
    bool converged = false;
    double fastest = 0;  ///< m/s, of any node
  };

  void reserve(const G& g, size_t slots);

  /// Replaces the velocities v* in g.nodes, before boundaries, by those after h s; with FLIP the gain goes to
  /// g.changes. `pull` is the acceleration that sets the scale of tolerances.
  Report solve(G& g, const Setting& set, double t, double h, double pull, const ThreadArena& arena);

 private:
  static constexpr double kTolerance = 1e-6;  ///< of velocities, in the mass norm
  static constexpr int kRounds = 12, kNewton = 40, kHalvings = 30, kMostProducts = 3000;
  static constexpr size_t kTangent = 2 * D * D + D * D + D * (D - 1);

  /// Newton's initial guess: v* after boundaries, or rest if that would invert a particle.
  void start(G& g, const ThreadArena& arena);

  /// Velocity gradient of a group for the node velocities in `tile`.
  static M gradient_of(const Stencils<D, Nodes, double>& at, const double* tile, double per_second);
  /// Visits every group of particles: visit(piece, slot, how many, stencil, h times the gradient of `nodes`,
  /// index of the tile).
  using Visit =
      FunctionRef<void(const Piece&, size_t, int, const Stencils<D, Nodes, double>&, const M&, size_t)>;
  void for_groups(G& g, const Vector& nodes, const ThreadArena& arena, Visit visit);
  /// out = the forces on nodes, times h (N s), of the stress `stress_of(piece, slot, h C)` of all particles,
  /// J/m^3 (P F^T of the substep's start).
  using StressOf = FunctionRef<M(const Piece&, size_t, const M&)>;
  void impulses(G& g, const Vector& nodes, Vector& out, const ThreadArena& arena, StressOf stress_of);

  static M moved(const double* group, const M& c) {
    M f = c;
    for (int k = 0; k < D; ++k) f(k, k) += W(1);
    return f * G::load_square(group, L::f);
  }

  /// Sum over blocks of nodes, in their order.
  template <class Of>
  double sum(const G& g, const ThreadArena& arena, const Of& of) {
    const size_t blocks = g.blocks.blocks.size();
    sums_.assign(blocks, 0);
    arena.for_blocks(blocks, 16, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        double part = 0;
        for (size_t i = k * G::kBlockNumbers; i < (k + 1) * G::kBlockNumbers; ++i) part += of(i);
        sums_[k] = part;
      }
    });
    double total = 0;
    for (const double s : sums_) total += s;
    return total;
  }
  double dot_of(const G& g, const Vector& a, const Vector& b, const ThreadArena& arena) {
    return sum(g, arena, [&](size_t i) { return a[i] * b[i]; });
  }
  /// Square of a residual in the norm of the inverse mass.
  double size_of(const G& g, const Vector& r, const ThreadArena& arena);

  /// E, or infinity if a particle is inverted whose law does not allow it.
  double energy(G& g, const Vector& v, const ThreadArena& arena);

  /// Computes the gradient of E at v_ and the particles' stiffness there.
  void linearise(G& g, const ThreadArena& arena);
  /// q_ = Hessian of E times p_.
  void product(G& g, const ThreadArena& arena);

  /// Inverses of m + sum_p V_p ((lambda + mu) b b^T + mu |b|^2), b = h times the gradient of the node's
  /// weight at the particle: the node's diagonal block of the Hessian at rest (linear elasticity).
  void invert_blocks(G& g, const ThreadArena& arena);
  /// z_ = inverse blocks times r_, in the free directions.
  void precondition();

  /// step_ ~ -Hessian^-1 gradient, until the residual has fallen by the factor `tolerance`.
  void direction(G& g, double tolerance, const ThreadArena& arena);

  /// Iterates until the gradient is `small` (in the norm of the inverse mass) in the free directions.
  bool newton(G& g, double small, const ThreadArena& arena);

  static constexpr double kRound = 1e-12, kNear = 100;
  const Setting* set_ = nullptr;
  double h_ = 0, push_ = 0, speed_ = 0;
  Vector v_, anchor_, gradient_, step_, r_, p_, q_, z_, tangents_;
  Vector inverse_;  ///< of a node's block: xx, xy, xz, yy, yz, zz
  std::vector<double> sums_, stored_;
  HeldNodes<D, Nodes> held_;
};

}  // namespace truestep::mpm
