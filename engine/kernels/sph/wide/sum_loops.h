// Sums over the neighbour lists of consecutive particles, sixteen floats at once: loops for processors with
// AVX-512, chosen when the program runs. They add in the order of systems/sph/lists/pair_list.h: the sums are
// the same to the bit.
#pragma once
#include <cstddef>
#include <cstdint>

namespace truestep::sph {

/// Lists of consecutive particles: particle k has the entries first[k] to first[k + 1], whole groups of eight
/// rows of four, gradient and twice the slot's offset from the group's first, `base`.
struct ListView {
  const int16_t* groups;
  const uint32_t *base, *first;
};

/// Factors of the entries: slope slopes[k] + weight weights[k]; without weights the first term alone.
struct PairFactors {
  float slope, weight;
  const float *slopes, *weights;
};

struct SumLoops {
  /// out[4 k + a], a < 3: the sum of gradients times numbers[slot] of particle k < count.
  void (*times)(const ListView&, size_t count, const float* numbers, float* out);
  /// out[k]: the sum of the products of gradients and rows[slot], rows of four on 16 bytes whose last number
  /// is 0.
  void (*dot)(const ListView&, size_t count, const float* rows, float* out);
  /// Row k of out: the sum of factors times rows[slot] - rows[own + k], rows as above.
  void (*differences)(const ListView&, size_t count, const PairFactors&, const float* rows, size_t own,
                      float* out);
};

/// nullptr where the processor has no AVX-512.
const SumLoops* wide_sum_loops();

}  // namespace truestep::sph
