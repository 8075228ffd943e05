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
  int solve(Fluid<D, T>& f, double t, double h, const ThreadArena& arena) const {
    for (auto* c : {&f.rest, &f.way, &f.image, &f.scale}) c->resize(4 * f.n);
    const double strength = (turns() ? 2 * (D + 2) : 2) * set_.def.viscosity * h;
    if (holds()) hold(f, t, h, arena);
    precondition(f, static_cast<T>(strength), arena);
    multiply(f, f.v, static_cast<T>(strength), arena);
    // The residual v* - (1 + h A) v at v = v*.
    const double start = sum_of(f, arena, [&](size_t i, size_t k) {
      T left = f.v[k] - f.image[k];
      if (holds()) left += f.hold[kHold * i + 6 + k % 4];
      f.rest[k] = f.fixed(i) ? T{0} : left;
      f.way[k] = f.scale[k] * f.rest[k];
      return double{f.rest[k]} * double{f.way[k]};
    });
    double now = start;
    int iterations = 0;
    const double enough = start * kTolerance * kTolerance;
    while (now > enough && iterations < set_.def.max_iterations) {
      multiply(f, f.way, static_cast<T>(strength), arena);
      const double across = sum_of(f, arena, [&](size_t i, size_t k) {
        if (f.fixed(i)) f.image[k] = 0;
        return double{f.way[k]} * double{f.image[k]};
      });
      if (!(across > 0)) break;
      const T along = static_cast<T>(now / across);
      const double next = sum_of(f, arena, [&](size_t, size_t k) {
        f.v[k] += along * f.way[k], f.rest[k] -= along * f.image[k];
        return double{f.rest[k]} * double{f.scale[k] * f.rest[k]};
      });
      const T turn = static_cast<T>(next / now);
      sum_of(f, arena, [&](size_t, size_t k) {
        f.way[k] = f.scale[k] * f.rest[k] + turn * f.way[k];
        return 0.0;
      });
      now = next, ++iterations;
    }
    return iterations;
  }

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
  void multiply(Fluid<D, T>& f, const Aligned<T>& u, T strength, const ThreadArena& arena) const {
    const bool turning = turns();
    f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
      W sums[D];
      for (auto& s : sums) s = W::zero();
      for (size_t k = begin; k < end; k += W::kLanes) {
        W other[4], g[D], along = W::zero();
        c.rows_of(u, k, other);
        for (size_t a = 0; a < D; ++a) {
          g[a] = c.gradient(a, k), other[a] = W::all(u[4 * i + a]) - other[a];
          along = madd(g[a], other[a], along);
        }
        const W by = weight(f, i, c, k, g, strength);
        for (size_t a = 0; a < D; ++a) sums[a] = madd(by, turning ? along * g[a] : other[a], sums[a]);
      }
      T* out = f.image.data() + 4 * i;
      const T* own = u.data() + 4 * i;
      out[2] = out[3] = 0;
      for (size_t a = 0; a < D; ++a) out[a] = own[a] + sum(sums[a]);
      if (!holds() || !(f.wall[4 * i + 3] > 0)) return;
      const T* m = f.hold.data() + kHold * i;
      out[0] += m[0] * own[0] + m[3] * own[1];
      out[1] += m[3] * own[0] + m[1] * own[1];
      if constexpr (D == 3) {
        out[0] += m[4] * own[2], out[1] += m[5] * own[2];
        out[2] += m[4] * own[0] + m[5] * own[1] + m[2] * own[2];
      }
    });
  }

  /// f.scale = 1 over the matrix's diagonal.
  void precondition(Fluid<D, T>& f, T strength, const ThreadArena& arena) const {
    const bool turning = turns();
    f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
      W sums[D];
      for (auto& s : sums) s = W::zero();
      for (size_t k = begin; k < end; k += W::kLanes) {
        W g[D];
        for (size_t a = 0; a < D; ++a) g[a] = c.gradient(a, k);
        const W by = weight(f, i, c, k, g, strength);
        for (size_t a = 0; a < D; ++a) sums[a] = madd(by, turning ? g[a] * g[a] : W::all(1), sums[a]);
      }
      T* out = f.scale.data() + 4 * i;
      out[2] = out[3] = 0;
      for (size_t a = 0; a < D; ++a) {
        const T walls = holds() ? f.hold[kHold * i + a] : T{0};
        out[a] = 1 / (1 + sum(sums[a]) + walls);
      }
    });
  }

  /// Drag of walls along themselves: h nu friction (1 - n n^T) (v - their velocity).
  void hold(Fluid<D, T>& f, double t, double h, const ThreadArena& arena) const {
    f.hold.resize(kHold * f.n);
    const double nu = set_.def.viscosity * h, least = kLeastGap * set_.def.spacing;
    arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        double m[kHold] = {};
        const double x[3] = {double{f.x[0][i]}, double{f.x[1][i]}, D == 3 ? double{f.x[2][i]} : 0};
        walls_.near(x, t, [&](double d, const Vec3& n, const Vec3& velocity, double full) {
          const double by = nu * full * set_.wall.friction(d, least);
          const Vec3 drag = (velocity - n * dot(velocity, n)) * by;
          m[0] += by * (1 - n.x * n.x), m[1] += by * (1 - n.y * n.y), m[2] += by * (1 - n.z * n.z);
          m[3] -= by * n.x * n.y, m[4] -= by * n.x * n.z, m[5] -= by * n.y * n.z;
          m[6] += drag.x, m[7] += drag.y, m[8] += drag.z;
        });
        for (size_t a = 0; a < kHold; ++a) f.hold[kHold * i + a] = static_cast<T>(m[a]);
      }
    });
  }

  const Setting& set_;
  const BoxWalls<D, T>& walls_;
};

}  // namespace truestep::sph
