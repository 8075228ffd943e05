// How far to go along a descent direction d: phi(a) is the function that d descends, with its slope phi'. A
// step a is accepted when phi falls by a fraction of what its slope promised (Armijo 1966),
//   phi(a) <= phi(0) + c a phi'(0),
// or, if rounding hides such a small decrease, when phi stays the same and the slope fulfils the condition
// for a parabola,
//   phi'(a) <= (2 c - 1) phi'(0)     (approximate Wolfe condition, Hager, Zhang 2005, eq. 4.1);
// otherwise a becomes the minimum of the cubic through values and slopes at both ends (Nocedal, Wright 2006,
// eq. 3.59), kept within [a / 10, a / 2]. A full step after which most of the slope is left is doubled.
#pragma once
#include <algorithm>
#include <cmath>

namespace truestep::line_search {

struct Point {
  double value, slope;  ///< phi and phi'
};

inline constexpr double kShare = 1e-4;      ///< c of Armijo's condition
inline constexpr double kSlopeShare = 0.1;  ///< c of the approximate condition
inline constexpr double kLeftSlope = 0.5;   ///< more than this fraction of the initial slope left: go on
inline constexpr double kLongest = 1024;
inline constexpr double kShortest = 1e-10;  ///< shorter steps do not count

/// Whether phi falls enough at step a.
inline bool falls(const Point& start, const Point& at, double a) {
  return at.value <= start.value + kShare * a * start.slope;
}

/// Whether phi stays the same to within `noise`, the rounding error of a value, and most of the slope is
/// gone.
inline bool settles(const Point& start, const Point& at, double noise) {
  return at.value <= start.value + noise && at.slope <= (2 * kSlopeShare - 1) * start.slope;
}

/// Whether the slope at an accepted step says that the minimum is farther away: a direction with less
/// curvature than its matrix assumed.
inline bool goes_on(const Point& start, const Point& at) {
  return at.slope < kLeftSlope * start.slope;
}

/// The next, shorter step to try; non-finite values shorten it the most.
inline double shorter(const Point& start, const Point& at, double a) {
  const double p = start.slope + at.slope - 3 * (at.value - start.value) / a;
  const double root = std::sqrt(p * p - start.slope * at.slope);
  const double cubic = a * (1 - (at.slope + root - p) / (at.slope - start.slope + 2 * root));
  if (std::isfinite(cubic)) return std::clamp(cubic, 0.1 * a, 0.5 * a);
  return std::isfinite(at.value) ? 0.5 * a : 0.1 * a;
}

}  // namespace truestep::line_search
