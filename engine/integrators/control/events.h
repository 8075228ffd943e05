// Events: times at which guards g_k(t, y) cross zero, found on the interpolant of each accepted step. Three
// points inside the step are checked besides its end; a guard that crosses and returns between two of them is
// missed. The earliest crossing is then refined by Chandrupatla's method (1997, "A new hybrid
// quadratic/bisection algorithm for finding the zero of a nonlinear function without using derivatives")
// until t is known to rounding, and the run stops at the first time known to be past it. The caller keeps the
// side of zero on which each guard was last seen, so that a restored run repeats every event. After an event
// its guard counts from the next point on, unless the event itself moved it back across zero.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/integrators/advance.h"

namespace truestep {

/// The guards of a run, evaluated together.
class Guards {
 public:
  virtual ~Guards() = default;
  /// Writes g_k(t, y) for all k.
  virtual void evaluate(double t, const double* y, double* g) = 0;
};

enum class Crossing : uint8_t { either, rising, falling };

/// Where between a and b a continuous function crosses zero, fa = f(a) and fb = f(b) having opposite signs
/// (fb may be 0): the end on b's side of a bracket no longer than `tolerance`, or than rounding allows.
template <class F>
double bracketed_root(F&& f, double a, double fa, double b, double fb, double tolerance) {
  const bool side_of_a = std::signbit(fa);
  if (fb == 0) return b;
  // (a, fa) is the newest point, (b, fb) the other end of the bracket, (c, fc) the one before.
  double c = a, fc = fa, share = 0.5;
  const auto behind = [&] { return std::signbit(fa) == side_of_a ? b : a; };
  for (int i = 0; i < 200; ++i) {
    const double x = a + share * (b - a), fx = f(x);
    if (fx == 0) return x;
    if (std::signbit(fx) == std::signbit(fa)) {
      c = a, fc = fa;
    } else {
      c = b, fc = fb, b = a, fb = fa;
    }
    a = x, fa = fx;
    const double best = std::abs(fa) < std::abs(fb) ? a : b;
    const double width = std::abs(b - a), limit = (2 * 2.3e-16 * std::abs(best) + 0.5 * tolerance) / width;
    if (!(limit <= 0.5)) return behind();
    // Inverse quadratic interpolation if it is monotonic between the three points, otherwise bisection.
    const double xi = (a - b) / (c - b), phi = (fa - fb) / (fc - fb);
    share = 0.5;
    if (phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi) {
      share = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb);
    }
    share = std::clamp(share, limit, 1 - limit);
  }
  return behind();
}

class EventWatcher final : public StepWatcher {
 public:
  /// The guards and their directions must outlive the watcher; n: number of equations.
  EventWatcher(Guards& guards, std::span<const Crossing> directions, size_t n);

  /// Side of zero per guard: -1, 1, or 0 if unknown; updated by `accepted` and `look`.
  void attach(std::span<int32_t> sides) { sides_ = sides; }
  Verdict accepted(double t0, double& t1, double* y1, const Interpolant& between) override;

  /// Guards that fired when `accepted` last returned stop, in order.
  const std::vector<uint32_t>& fired() const { return fired_; }
  void clear() {
    fired_.clear();
    fired_side_.clear();
  }
  /// Takes the present sides of all guards as their previous ones; 0 for those that fired and have not been
  /// moved back since: rounding decides on which side of zero they are.
  void look(double t, const double* y);

 private:
  bool crosses(size_t k) const;
  bool any_crosses() const;
  void keep_sides();
  double earliest(double t0, double h, double low, double high, const Interpolant& between);

  Guards& guards_;
  std::span<const Crossing> directions_;
  std::span<int32_t> sides_;
  std::vector<double> now_, before_, ahead_, point_;
  std::vector<uint32_t> fired_;
  std::vector<int32_t> fired_side_;  ///< per fired guard, the side that it crossed to
};

}  // namespace truestep
