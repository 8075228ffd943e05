// Discrete Fourier transforms of eight complex lines side by side, so that every butterfly runs in vector
// lanes: X_k = sum_j x_j exp(-2 pi i j k / n). Stockham's self-sorting form with radices 4, 2, 3 and 5 (Van
// Loan 1992, "Computational frameworks for the fast Fourier transform", section 1.7); any other length as a
// convolution of one of those (Bluestein 1970). Not normalised; the inverse is the transform of the
// conjugate.
#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "engine/base/cache_line.h"

namespace truestep {

class Fft {
 public:
  static constexpr size_t kLanes = 8;
  /// Doubles per element: the real parts of its lanes, then the imaginary ones.
  static constexpr size_t kElement = 2 * kLanes;
  using Buffer = std::vector<double, CacheLineAllocator<double>>;

  explicit Fft(size_t n);
  ~Fft();
  Fft(Fft&&) noexcept;
  size_t size() const { return n_; }
  /// Size of `scratch` in doubles.
  size_t scratch_size() const;
  /// In place: n elements at `x`.
  void run(double* x, double* scratch) const;

 private:
  struct Stage {
    size_t radix, length, stride;  ///< of the remaining transform, and between its elements
    std::vector<double> twiddles;  ///< exp(-2 pi i j p / length), j = 1 ... radix - 1 for every p
  };
  struct Chirp;
  size_t n_;
  std::vector<Stage> stages_;
  std::unique_ptr<Chirp> chirp_;  ///< lengths with a prime factor above 5
};

}  // namespace truestep
