// Arc length of a curve in space, for motion along it at constant speed. The length s(t) = integral |x'(t)|
// dt is tabulated by five-point Gauss quadrature on equal intervals; the time of a given length is found by
// interpolating the table and by Newton's method on s(t) - s = 0, whose derivative is the speed.
#pragma once
#include <vector>

#include "engine/kernels/animation/key_curve.h"

namespace truestep::animation {

class ArcLength {
 public:
  ArcLength() = default;
  /// For a curve of width 3, with `intervals` per pair of keys.
  explicit ArcLength(const KeyCurve& curve, size_t intervals = 16);
  /// m, length of the whole curve.
  double total() const { return lengths_.empty() ? 0 : lengths_.back(); }
  /// m, from the first key to time t (s) between the first and the last one.
  double length(const KeyCurve& curve, double t) const;
  /// s, time at which the distance from the first key is `length`, clamped to [0, total].
  double time_at(const KeyCurve& curve, double length) const;

 private:
  double start_ = 0, step_ = 1;  // s
  std::vector<double> lengths_;  // m, at the ends of the intervals
};

}  // namespace truestep::animation
