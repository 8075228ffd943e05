// Divergence-free SPH (Bender & Koschier 2015, 2017): pressures that leave velocities without divergence, and
// then pressures that bring the density after the substep to that at rest. Both are relaxed Jacobi iterations
// with pressures that do not pull, and begin from the pressures of the substep before.
#pragma once
#include "engine/systems/sph/passes.h"

namespace truestep::sph {

struct SolveResult {
  int iterations = 0;
  double mean = 0, most = 0;  ///< relative compression that is left
};

template <int D, class T>
class Dfsph {
 public:
  explicit Dfsph(const Setting& set) : set_(set) {}

  /// Velocities without divergence at the places where particles are; `h` s is the substep.
  SolveResult stop_flow(Fluid<D, T>& f, double h, const ThreadArena& arena) const {
    // Particles with less than half a neighbourhood are spray.
    constexpr T kSpray = T(0.5);
    f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
      const T rate = compression<D, T>(f, f.v, i, c, begin, end) + f.drive[i];
      f.source[i] = f.delta[i] < kSpray ? std::min(rate, T{0}) : rate;
    });
    return relax(f, f.flow, static_cast<T>(1 / h), h * h, arena);
  }
  /// Density at rest after a substep of h s with the velocities that are there.
  SolveResult stop_compression(Fluid<D, T>& f, double h, const ThreadArena& arena) const {
    const T step = static_cast<T>(h);
    f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
      const T rate = compression<D, T>(f, f.v, i, c, begin, end) + f.drive[i];
      f.source[i] = f.delta[i] - 1 + step * rate;
    });
    return relax(f, f.push, static_cast<T>(1 / (h * h)), h * h, arena);
  }

 private:
  /// Solves for q >= 0 such that no compression scale * source remains; `error` makes it relative. Kicks.
  SolveResult relax(Fluid<D, T>& f, Aligned<T>& q, T scale, double error, const ThreadArena& arena) const {
    constexpr T kRelaxation = T(0.5);
    constexpr int kLeast = 2;
    const T least = static_cast<T>(1e-6 / (set_.support * set_.support));
    SolveResult out;
    while (out.iterations < set_.def.max_iterations) {
      push_by<D, T>(f, q, arena);
      const auto left = f.tally(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
        const T rest = scale * f.source[i] + compression<D, T>(f, f.a, i, c, begin, end);
        q[i] = f.stiffness[i] > least ? std::max(q[i] + kRelaxation * rest / f.stiffness[i], T{0}) : T{0};
        return std::max(double{rest} * error, 0.0);
      });
      ++out.iterations;
      out.mean = left.sum / static_cast<double>(f.n), out.most = left.most;
      if (out.iterations >= kLeast && out.mean <= set_.def.density_error) break;
    }
    push_by<D, T>(f, q, arena);
    kick(f, static_cast<T>(std::sqrt(error)), arena);
    return out;
  }

  const Setting& set_;
};

}  // namespace truestep::sph
