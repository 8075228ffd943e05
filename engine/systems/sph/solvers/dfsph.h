// Divergence-free SPH (Bender & Koschier 2015, 2017): one solve for pressures that remove the compression
// from the velocity field, one for pressures that bring the density at the end of the substep to the rest
// density. Both start from the pressures of the previous substep; pressure never pulls. In the first a wall
// is the fluid's mirror image: were it a region at rest, the even rows of a lattice could fall through the
// odd ones (the gradient at a row sees only the two rows next to it). In the second it is what the density
// sums up. A liquid that fills a box without sides cannot part, and its density has no room to yield: there
// pressures pull too, only differences count (their mean is 0), the first solve is the only one and particles
// keep their density by being shifted, as in projection methods (Lind, Xu, Stansby & Rogers 2012).
#pragma once
#include <algorithm>
#include <array>
#include <limits>

#include "engine/systems/sph/bodies.h"

namespace truestep::sph {

struct SolveResult {
  int iterations = 0;
  double mean = 0, most = 0;  ///< relative compression left per substep
};

template <int D, class T>
class Dfsph {
 public:
  explicit Dfsph(const Setting& set) : set_(set) {}

  struct Solved {
    SolveResult flow, push;
  };
  /// A substep of `h` s. Of the compression that a substep may remove it removes the part `share`; it is the
  /// part `part` of the time in which the flow moves as far as in a substep it may. Its solves may leave the
  /// part `tolerance` of the density error.
  struct Pace {
    double h, share, part, tolerance;
  };
  /// Removes compression from the velocities (a torn region may close, by a part of the gap per substep),
  /// then makes them such that the density after a substep is the rest density, or nearer to it by `part`:
  /// corrected at once, in substeps that viscosity makes short, an error that the flow does not feel would
  /// take pressures that shake it.
  Solved solve(Fluid<D, T>& f, BodiesIn<D, T>& bodies, const Pace& pace, const ThreadArena& arena) const;

 private:
  /// A solve ends on the mean error; the largest may be this many times as large.
  static constexpr double kMostOverMean = 10;
  static constexpr int kLeastIterations = 2;
  /// A solve that starts with less than this part of the mean error it may leave ends at once.
  static constexpr double kEnough = 0.25;
  /// A density below kGap times the rest density is a gap, of which a substep may close kClosing.
  static constexpr double kGap = 0.9, kClosing = 0.1;
  /// At most this much compression is removed per substep: an overlap at the start separates calmly.
  static constexpr double kMostAtOnce = 0.02;

  /// The start pressures q of a solve, copied into `start` and `iterate`; particles that nothing moves have
  /// none.
  static void begin_from(Fluid<D, T>& f, Aligned<T>& q, const ThreadArena& arena);
  /// Applies pressures q for h s; f.a is their effect on the particles.
  template <Answer A>
  static void move(Fluid<D, T>& f, BodiesIn<D, T>& bodies, const Aligned<T>& q, double h,
                   const ThreadArena& arena) {
    kick(f, static_cast<T>(h), arena);
    if (bodies.any()) bodies.template answer<A>(q), bodies.follow(f, h);
  }

  /// Solves for q >= 0 (in a closed box, for q with the mean 0), starting from begin_from, such that no
  /// compression remains. The velocities already contain the effect of the initial q, and residual(slot,
  /// sum of g v_j) is the compression (1/s^2) left in them; `error` makes it relative. Leaves in
  /// f.change the change from the initial pressures. Projected gradient method with Nesterov's acceleration,
  /// restarted where it goes uphill (O'Donoghue & Candes 2015): the matrix is symmetric and has no negative
  /// eigenvalue.
  template <Answer A, class Residual>
  SolveResult relax(Fluid<D, T>& f, BodiesIn<D, T>& bodies, Aligned<T>& q, double error,
                    const ThreadArena& arena, const Residual& residual) const {
    const bool any = bodies.any();
    const T floor = set_.closed ? std::numeric_limits<T>::lowest() : T{0};
    T mean = 0;  // of the residuals, in a closed box: pressures cannot change it
    const T least = static_cast<T>(1e-6 / (set_.support * set_.support));
    T relaxation = static_cast<T>(set_.relaxation);
    SolveResult out;
    double best = HUGE_VAL;
    int run = 0;
    for (;;) {
      const bool first = out.iterations == 0;
      if (!first) {
        push_by<A>(f, f.change, arena);
        if (any) bodies.template answer<A>(f.change);
      }
      const T beyond = static_cast<T>(run) / static_cast<T>(run + 3);
      const auto left = f.tally_dots(first ? f.v : f.a, arena, [&](size_t i, T others) {
        if (f.fixed(i)) {
          f.iterate[i] = f.next[i] = 0;
          return std::array<double, 3>{0, 0, 0};
        }
        T rest;
        if (first) {
          rest = f.source[i] = residual(i, others);
        } else {
          rest = f.source[i] + compression<A, D, T>(f, f.a, i, others);
          if (any) rest += bodies.recoil(i);
        }
        const T total = rest;
        rest -= mean;
        T own = f.stiffness[i];
        if constexpr (A == Answer::mirror) {
          const T *pull = f.pull.data() + 4 * i, *wall = f.wall.data() + 4 * i;
          for (size_t k = 0; k < D; ++k) own += f.lightness(i) * wall[k] * (2 * pull[k] + wall[k]);
        }
        if (any) own += bodies.template give<A>(i);
        // Where there is pressure, expansion is an error too.
        const double wrong = q[i] > floor ? std::abs(double{rest}) : std::max(double{rest}, 0.0);
        const T to = own > least ? std::max(q[i] + relaxation * rest / own, floor) : T{0};
        const T way = to - f.iterate[i];
        f.iterate[i] = to, f.next[i] = std::max(to + beyond * way, floor);
        return std::array<double, 3>{wrong * error, double{rest} * double{way}, double{total}};
      });
      ++out.iterations;
      if (set_.closed) {
        mean = static_cast<T>(left.third / static_cast<double>(f.n));
        center(f, f.iterate, arena), center(f, f.next, arena);
      }
      out.mean = left.sum / std::max(static_cast<double>(f.n), 1.0), out.most = left.most;
      const double part = out.iterations < kLeastIterations ? kEnough : 1;
      const bool good =
          out.mean <= part * set_.def.density_error && out.most <= kMostOverMean * set_.def.density_error;
      if (good || out.iterations >= set_.def.max_iterations) break;
      if (out.mean > 10 * best) relaxation *= T(0.5), best = HUGE_VAL;
      best = std::min(best, out.mean);
      ++run;
      if (left.second < 0) run = 0;
      go_to(f, q, left.second < 0 ? f.iterate : f.next, arena);
    }
    go_to(f, q, f.iterate, arena);
    return out;
  }
  /// Subtracts the mean of q.
  static void center(Fluid<D, T>& f, Aligned<T>& q, const ThreadArena& arena);
  /// q becomes `to`, f.change its difference from the start.
  static void go_to(Fluid<D, T>& f, Aligned<T>& q, const Aligned<T>& to, const ThreadArena& arena);

  const Setting& set_;
};

}  // namespace truestep::sph
