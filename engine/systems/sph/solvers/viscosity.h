// Implicit viscosity: velocities v = v* + h a(v) by conjugate gradients with a diagonal preconditioner,
// stable for any substep. The forces a are those of the explicit step, 2 nu sum V |W'| / r (v_j - v_i)
// (Morris, Fox & Zhu 1997), or 2 (d + 2) nu sum V (v_ij . x_ij) / |x_ij|^2 grad W (Weiler, Koschier, Brand &
// Bender 2018, equations 8 to 11; without their 0.01 h^2: pairs at the kernel's rim, where the gradient
// vanishes, are left out instead). Both conserve momentum; the second also conserves angular momentum, but is
// a third too weak along the rows of a lattice if the kernel reaches two spacings. No-slip walls enter the
// matrix. Particles that nothing moves act as given velocities.
#pragma once
#include <algorithm>
#include <array>

#include "engine/systems/sph/solvers/passes.h"
#include "engine/systems/sph/walls.h"

namespace truestep::sph {

template <int D, class T>
class ImplicitViscosity {
 public:
  ImplicitViscosity(const Setting& set, const BoxWalls<D, T>& walls) : set_(set), walls_(walls) {}

  /// Applies h s of viscosity to f.v at time t; returns the number of iterations.
  int solve(Fluid<D, T>& f, double t, double h, const ThreadArena& arena) const;

 private:
  using W = Wide<T>;
  /// Relative to the change by viscosity in a substep, in the norm of the conjugate gradients.
  static constexpr double kTolerance = sizeof(T) == 8 ? 1e-6 : 1e-4;
  /// Numbers per row: a symmetric matrix (xx yy zz xy xz yz) and the contribution of moving walls.
  static constexpr size_t kHold = 9;

  bool turns() const { return set_.def.viscosity_step == Viscous::weiler2018; }
  bool holds() const { return set_.def.walls == Walls::no_slip; }

  /// Sum of body(row, component) over all rows, each weighted by its density.
  template <class Body>
  double sum_of(Fluid<D, T>& f, const ThreadArena& arena, const Body& body) const {
    f.partial.resize((f.n + kBlockRows - 1) / kBlockRows);
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      double sum = 0;
      for (size_t i = begin; i < end; ++i) {
        double own = 0;
        for (size_t a = 0; a < D; ++a) own += body(i, 4 * i + a);
        sum += f.weighted && f.light[i] > 0 ? own / double{f.light[i]} : own;
      }
      f.partial[begin / kBlockRows] = sum;
    });
    double out = 0;
    for (const double p : f.partial) out += p;
    return out;
  }

  /// Weight of a pair, on g g^T or the unit matrix; at least 0.
  W weight(const Fluid<D, T>& f, size_t i, const Chunk<T>& c, size_t k, const W* g, T strength) const {
    W out = W::all(-strength) * load(c.s.data() + k);
    if (turns()) {
      const double reach = set_.support * double{f.unit};
      W square = W::all(static_cast<T>(kRim / (reach * reach)));
      for (size_t a = 0; a < D; ++a) square = madd(g[a], g[a], square);
      out = out / square;
    }
    return f.weighted ? out * part_of_pair(f, i, c, k) : out;
  }
  static constexpr double kRim = 1e-10;

  /// f.image = (1 + h A) u.
  void multiply(Fluid<D, T>& f, const Aligned<T>& u, T strength, const ThreadArena& arena) const;

  /// f.scale = 1 over the matrix's diagonal.
  void precondition(Fluid<D, T>& f, T strength, const ThreadArena& arena) const;

  /// Drag of walls along themselves: h nu friction (1 - n n^T) (v - their velocity).
  void hold(Fluid<D, T>& f, double t, double h, const ThreadArena& arena) const;

  const Setting& set_;
  const BoxWalls<D, T>& walls_;
};

}  // namespace truestep::sph
