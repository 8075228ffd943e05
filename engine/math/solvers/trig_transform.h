// Real transforms that make second differences of nodes on a line diagonal, one per pair of its ends, as
// Fourier transforms of the line's symmetric extension:
//   ends            nodes (of 0 ... n)   waves                     extension
//   zero, zero      1 ... n-1            sin(pi j k / n)           odd, odd           (DST-I)
//   even, even      0 ... n              cos(pi j k / n)           even, even         (DCT-I)
//   zero, even      1 ... n              sin(pi j (k + 1/2) / n)   odd, even          (DST-III)
//   even, zero      0 ... n-1            the same from the other end
//   periodic        0 ... n-1            cos + sin (2 pi j k / n)  none               (Hartley)
// Coefficients are stored where the nodes are, those of (zero, even) one place further, so that every
// transform is in place; values at zero ends are neither read nor written. Sixteen lines are transformed at
// once, two in each complex lane (Strang 1999, "The discrete cosine transform"; Bracewell 1983 for
// Hartley's).
#pragma once
#include "engine/math/solvers/fft.h"

namespace truestep {

class TrigTransform {
 public:
  enum class End : uint8_t { zero, even, periodic };
  static constexpr size_t kLines = 2 * Fft::kLanes;

  /// n spacings between the ends.
  TrigTransform(End low, End high, size_t n);
  size_t nodes() const { return low_ == End::periodic ? n_ : n_ + 1; }
  size_t first() const { return low_ == End::zero ? 1 : 0; }
  size_t last() const { return high_ == End::even ? n_ : n_ - 1; }
  /// Angle of the wave whose coefficient is at index i: its second difference is 2 cos(angle) - 2 times
  /// itself.
  double angle(size_t i) const;

  size_t scratch_size() const;
  /// `count` <= kLines lines; element j of line l at x[j * node_stride + l * line_stride].
  void forward(double* x, size_t node_stride, size_t line_stride, size_t count, double* scratch) const;
  /// forward's inverse.
  void backward(double* x, size_t node_stride, size_t line_stride, size_t count, double* scratch) const;

 private:
  enum class Way : uint8_t { forward, backward };
  void run(Way way, double* x, size_t node_stride, size_t line_stride, size_t count, double* scratch) const;

  End low_, high_;
  size_t n_;
  Fft fft_;
};

}  // namespace truestep
