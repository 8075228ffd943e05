// lap x = b on the cells of a staggered grid with partly open faces (cut cells: Ng, Min, Gibou 2009, "An
// efficient fluid-solid coupling algorithm for single-phase flows", section 3): the flux through every face
// is weighted with its open fraction. Conjugate gradients with one multigrid cycle as preconditioner (Tatebe
// 1993, "The multigrid preconditioned conjugate gradient method"): red-black relaxation in opposite orders
// before and after, linear interpolation between cell centres and its transpose, coarse faces that conduct as
// much as the fine ones together.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/parallel.h"
#include "engine/kernels/mac/ghosts.h"

namespace truestep::lattice {

class CutPoisson {
 public:
  using Vector = std::vector<double, CacheLineAllocator<double>>;
  /// Open fractions of the faces of each axis, in the grid's own arrays; on `odd` sides the value is 0, other
  /// sides are closed.
  CutPoisson(const mac::MacGrid& grid, const std::array<std::array<mac::Mirror, 2>, 3>& mirrors,
             const std::array<Vector, 3>& open);
  /// All faces are closed until `set` is called.
  CutPoisson(const mac::MacGrid& grid, const std::array<std::array<mac::Mirror, 2>, 3>& mirrors);

  /// Sets other weights of the faces, which may exceed 1: the factor of a difference relative to that of an
  /// open face. `liquid` (per cell, in the grid's own arrays; null: all): all other cells hold 0, and so does
  /// a coarse cell with one of them next to the liquid (McAdams, Sifakis, Teran 2010, "A parallel multigrid
  /// Poisson solver for fluids simulation on large grids", section 3.3). Does not allocate.
  void set(const std::array<const double*, 3>& open, const uint8_t* liquid, const ThreadArena& arena);

  /// The same for factors that jump but are never 0, such as 1 / density of two fluids: a coarse face
  /// conducts like the fine ones between the centres of its cells in series. Does not allocate.
  void set_coefficients(const std::array<const double*, 3>& factors, const ThreadArena& arena);

  struct Outcome {
    int iterations = 0;
    double residual = 0;  ///< relative to that of x = 0, root mean square
  };
  /// In place, in the grid's own arrays; cells without an open face become 0.
  Outcome solve(double* x, double tolerance, const ThreadArena& arena);
  size_t levels() const { return levels_.size(); }

  static constexpr int kMostIterations = 200;

 private:
  struct Between {
    uint32_t low, high;  ///< the two coarse cells around a fine one
    double part;         ///< of the high one
  };
  struct Axis {
    std::vector<Between> up;                                     ///< per fine cell
    std::vector<std::vector<std::pair<uint32_t, double>>> down;  ///< per coarse cell
  };
  /// Cells with one ghost beyond every side; k[a] of a cell belongs to the face after it along a.
  struct Level {
    std::array<size_t, 3> n{1, 1, 1}, padded{1, 1, 1};
    std::array<std::vector<double>, 3> width;  ///< of the cells, m
    std::array<bool, 3> halved{};              ///< to the next level
    std::array<Vector, 3> k;                   ///< m^(d-2)
    Vector inverse, x, b, r;
    std::vector<uint8_t> held;  ///< 1: cell next to the liquid that holds 0; empty if none
    std::array<Axis, 3> to_coarser;
    size_t stride(size_t a) const { return a == 0 ? 1 : a == 1 ? padded[0] : padded[0] * padded[1]; }
    size_t at(size_t i, size_t j, size_t l) const { return base + i + stride(1) * j + stride(2) * l; }
    size_t size() const { return padded[0] * padded[1] * padded[2]; }
    size_t base = 0;
  };
  void shape(Level& l) const;
  void invert(Level& l, const ThreadArena& arena) const;
  /// Adds the next coarser level; false if there is none.
  bool coarsen();
  void fill_coarser(const Level& fine, Level& coarse, const ThreadArena& arena) const;
  void wrap(const Level& l, double* x, const ThreadArena& arena) const;
  /// Relaxes the cells of both colours, starting with `first`; from 0 the values of x do not matter.
  enum class From : uint8_t { zero, values };
  void relax(const Level& l, size_t first, From from, const double* b, double* x,
             const ThreadArena& arena) const;
  void relax_row(const Level& l, size_t colour, From from, const double* b, double* x, size_t j,
                 size_t q) const;
  /// r = b - A x, or A x if b is null.
  void residual(const Level& l, const double* b, double* x, double* r, const ThreadArena& arena) const;
  void cycle(size_t level, const double* b, double* x, const ThreadArena& arena);
  void restrict_to(const Level& fine, Level& coarse, const ThreadArena& arena) const;
  void correct(const Level& fine, const Level& coarse, double* x, const ThreadArena& arena) const;
  double product(const double* a, const double* b, const ThreadArena& arena);
  double sum(const Vector& of, const ThreadArena& arena);
  /// Of part(begin, end) over fixed blocks of [0, n), in their order.
  template <class F>
  double total(size_t n, const ThreadArena& arena, F&& part);
  /// `weight`: cost of a cell in a pass over a level, relative to one that only touches it.
  template <class F>
  void rows(const Level& l, const ThreadArena& arena, size_t weight, F&& f) const;
  template <class F>
  void rows(const Level& l, const ThreadArena& arena, F&& f) const {
    rows(l, arena, 1, std::forward<F>(f));
  }
  static constexpr size_t kFineRows = 8;  ///< of a coarse cell that reads all its fine ones

  mac::MacGrid grid_;
  std::array<std::array<mac::Mirror, 2>, 3> mirrors_;
  bool singular_ = true, surface_ = false;
  enum class Coarse : uint8_t { shares, series } coarse_ = Coarse::shares;
  double fluid_cells_ = 0;
  std::vector<Level> levels_;
  Vector b_, r_, z_, p_, q_;
  std::vector<double> sums_;
};

/// f(offset of the row's first cell, its j, its l) for every row of cells along x, in parallel.
template <class F>
void CutPoisson::rows(const Level& l, const ThreadArena& arena, size_t weight, F&& f) const {
  const size_t block = std::max<size_t>(1, kBlockRows / (weight * l.n[0]));
  arena.for_blocks(l.n[1] * l.n[2], block, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) f(l.at(0, r % l.n[1], r / l.n[1]), r % l.n[1], r / l.n[1]);
  });
}

template <class F>
double CutPoisson::total(size_t n, const ThreadArena& arena, F&& part) {
  sums_.resize((n + kBlockRows - 1) / kBlockRows);
  arena.for_blocks(n, kBlockRows,
                   [&](size_t begin, size_t end) { sums_[begin / kBlockRows] = part(begin, end); });
  double all = 0;
  for (const double s : sums_) all += s;
  return all;
}

}  // namespace truestep::lattice
