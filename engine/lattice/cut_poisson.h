// lap x = b on the cells of a staggered grid whose faces are open in part (cut cells: Ng, Min, Gibou 2009,
// "An efficient fluid-solid coupling algorithm for single-phase flows", section 3): every face lets pass what
// its open share does. Conjugate gradients with one multigrid cycle as preconditioner (Tatebe 1993, "The
// multigrid preconditioned conjugate gradient method"): red and black relaxation in opposite orders before
// and after, linear interpolation between centres of cells and its transpose, coarse faces that let pass what
// the fine ones do.
#pragma once
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/parallel.h"
#include "engine/kernels/mac/ghosts.h"

namespace truestep::lattice {

class CutPoisson {
 public:
  using Vector = std::vector<double, CacheLineAllocator<double>>;
  /// Open shares of the faces of each axis, in the grid's own arrays; sides that are `odd` hold 0, others are
  /// closed.
  CutPoisson(const mac::MacGrid& grid, const std::array<std::array<mac::Mirror, 2>, 3>& mirrors,
             const std::array<Vector, 3>& open);
  /// Without an open face until `set`.
  CutPoisson(const mac::MacGrid& grid, const std::array<std::array<mac::Mirror, 2>, 3>& mirrors);

  /// Other shares of the faces, which may be greater than 1: what a difference of values counts beside that
  /// of an open face. `liquid` (of cells, in the grid's own arrays; null: all): the others hold 0, and a
  /// coarse cell with one of them next to the liquid does so too (McAdams, Sifakis, Teran 2010, "A parallel
  /// multigrid Poisson solver for fluids simulation on large grids", section 3.3). Allocates nothing.
  void set(const std::array<const double*, 3>& open, const uint8_t* liquid, const ThreadArena& arena);

  struct Outcome {
    int iterations = 0;
    double residual = 0;  ///< over that of x = 0, in the mean square
  };
  /// In place, in the grid's own arrays; cells without an open face become 0.
  Outcome solve(double* x, double tolerance, const ThreadArena& arena);
  size_t levels() const { return levels_.size(); }

  static constexpr int kMostIterations = 200;

 private:
  struct Between {
    uint32_t low, high;  ///< coarse cells around a fine one
    double part;         ///< of the high one
  };
  struct Axis {
    std::vector<Between> up;                                     ///< per fine cell
    std::vector<std::vector<std::pair<uint32_t, double>>> down;  ///< per coarse cell
  };
  /// Cells with one more beyond every side; k[a] of a cell is its face after it along a.
  struct Level {
    std::array<size_t, 3> n{1, 1, 1}, padded{1, 1, 1};
    std::array<std::vector<double>, 3> width;  ///< of the cells, m
    std::array<bool, 3> halved{};              ///< to the next level
    std::array<Vector, 3> k;                   ///< m^(d-2)
    Vector inverse, x, b, r;
    std::vector<uint8_t> held;  ///< next to the liquid and 0; empty where there is none
    std::array<Axis, 3> to_coarser;
    size_t stride(size_t a) const { return a == 0 ? 1 : a == 1 ? padded[0] : padded[0] * padded[1]; }
    size_t at(size_t i, size_t j, size_t l) const { return base + i + stride(1) * j + stride(2) * l; }
    size_t size() const { return padded[0] * padded[1] * padded[2]; }
    size_t base = 0;
  };
  void shape(Level& l) const;
  void invert(Level& l, const ThreadArena& arena) const;
  /// The shape of the next level; false where there is none.
  bool coarsen();
  void fill_coarser(const Level& fine, Level& coarse, const ThreadArena& arena) const;
  void wrap(const Level& l, double* x) const;
  void relax(const Level& l, size_t colour, const double* b, double* x, const ThreadArena& arena) const;
  /// r = b - A x, or A x where b is null.
  void residual(const Level& l, const double* b, double* x, double* r, const ThreadArena& arena) const;
  void cycle(size_t level, const double* b, double* x, const ThreadArena& arena);
  void restrict_to(const Level& fine, Level& coarse, const ThreadArena& arena) const;
  void correct(const Level& fine, const Level& coarse, double* x, const ThreadArena& arena) const;
  double product(const double* a, const double* b, const ThreadArena& arena);
  template <class F>
  void rows(const Level& l, const ThreadArena& arena, F&& f) const;

  mac::MacGrid grid_;
  std::array<std::array<mac::Mirror, 2>, 3> mirrors_;
  bool singular_ = true, surface_ = false;
  double fluid_cells_ = 0;
  std::vector<Level> levels_;
  Vector b_, r_, z_, p_, q_;
  std::vector<double> sums_;
};

}  // namespace truestep::lattice
