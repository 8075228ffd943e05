// Geometric multigrid for A x = (shift I - step L) x = b with variable coefficients and sides of any kind,
// second order in space, real or complex: V-cycles with red-black Gauss-Seidel relaxation, linear
// interpolation along every axis, its adjoint as restriction, and the equation rediscretized on every coarser
// lattice (Trottenberg, Oosterlee, Schueller 2001, "Multigrid", sections 2.4 and 5.2), the coarsest solved
// directly. The number of cells need not be even: the coarser lattice has half as many, rounded up, at its
// own positions. Axes are coarsened together while their spacings are similar, otherwise only the finest
// (semi-coarsening, section 5.1). Relaxation in opposite orders before and after makes a cycle self-adjoint
// in the nodes' volumes, so that it can serve as preconditioner of conjugate gradients (complex ones in the
// bilinear form: van der Vorst, Melissen 1990).
#pragma once
#include <functional>

#include "engine/lattice/solvers/shifted_solver.h"
#include "engine/math/solvers/dense_lu.h"

namespace truestep::lattice {

template <class T>
class Multigrid {
 public:
  using Vector = std::vector<T, CacheLineAllocator<T>>;
  /// Constructs the second-order operator on a lattice of the same box.
  using Discretise = std::function<Diffusion(const Lattice&)>;

  Multigrid(const Lattice& finest, const Discretise& discretise);
  /// False if the result is not finite, or singular on the coarsest lattice.
  bool factor(T shift, T step);

  size_t levels() const { return levels_.size(); }
  /// x becomes the approximation of A^-1 b by one cycle from zero; Dirichlet nodes of b are taken as 0.
  void cycle(const T* b, T* x, const ThreadArena& arena);
  /// Conjugate gradients with one cycle as preconditioner, from x = 0, until the volume-weighted residual has
  /// fallen to the fraction `reduction` of its initial value; returns the number of iterations.
  int solve(const T* b, T* x, double reduction, const ThreadArena& arena);
  /// r = b - A x, 0 at Dirichlet nodes.
  void residual(const T* b, const T* x, T* r, const ThreadArena& arena) const;
  /// Root of the sum over nodes of volume |r|^2.
  double norm(const T* r, const ThreadArena& arena) const;

  static constexpr int kMostIterations = 200;

 private:
  /// One axis between a lattice and the next coarser one.
  struct Transfer {
    bool same = true;
    struct Between {
      uint32_t low, high;
      double part;  ///< of the high one
    };
    std::vector<Between> up;                                     ///< per fine node
    std::vector<std::vector<std::pair<uint32_t, double>>> down;  ///< per coarse node
  };
  struct Level {
    Diffusion a;
    std::vector<double> diagonal, volume;  ///< volume 0 at Dirichlet nodes
    Vector inverse, x, b, r;
    std::array<Transfer, 3> to_coarser;
  };
  void relax(const Level& l, size_t colour, const T* b, T* x, const ThreadArena& arena) const;
  void residual(const Level& l, const T* b, const T* x, T* r, const ThreadArena& arena) const;
  void descend(size_t level, const T* b, T* x, const ThreadArena& arena);
  void restrict_to(const Level& fine, Level& coarse, const T* r);
  void correct(const Level& fine, const Level& coarse, T* x);
  T product(const T* a, const T* b, const ThreadArena& arena) const;

  std::vector<Level> levels_;
  T shift_{1}, step_{0};
  DenseLu<T> coarsest_;
  Vector half_, r_, z_, p_, q_;
};

/// The real and the complex solver behind one interface.
class MultigridSolver final : public ShiftedSolver {
 public:
  MultigridSolver(const Lattice& finest, Multigrid<double>::Discretise discretise);
  bool factor(double shift, double step) override;
  bool factor(Complex shift, Complex step) override;
  void solve(double* b, const ThreadArena& arena) override;
  void solve(double* re, double* im, const ThreadArena& arena) override;

 private:
  /// Below what Newton's method notices.
  static constexpr double kReduction = 1e-10;
  Lattice lattice_;
  Multigrid<double>::Discretise discretise_;
  Diffusion fine_;
  double step_ = 0;
  Complex complex_step_;
  std::unique_ptr<Multigrid<double>> real_;
  std::unique_ptr<Multigrid<Complex>> complex_;
  std::vector<uint32_t> fixed_;
  std::vector<double> given_, moved_, x_;
  Multigrid<Complex>::Vector cb_, cx_;
};

}  // namespace truestep::lattice
