#include "engine/sinks/recording/file/fletcher32.h"

#include <algorithm>
#include <cstring>

namespace truestep {
namespace {

constexpr size_t kLanes = 16;
using Vector = uint32_t __attribute__((vector_size(2 * kLanes)));
// Largest number of words per lane before a 32-bit s2 overflows: n (n + 1) / 2 * 65535 < 2^32.
constexpr size_t kBlock = 360;

// Non-zero multiples of 65535 stay 65535, as repeated folding leaves them.
uint32_t reduce(uint64_t v) {
  if (v == 0) return 0;
  const uint32_t r = static_cast<uint32_t>(v % 65535);
  return r == 0 ? 65535 : r;
}

}  // namespace

uint32_t fletcher32(const void* data, size_t size) {
  const auto* p = static_cast<const unsigned char*>(data);
  const size_t words = size / 2;
  uint64_t s1 = 0, s2 = 0;  // of the words taken little-endian, modulo 65535

  // Lanes of words strided by kLanes: lane l holds words l, l + kLanes, ... of a block, so that
  // s2 of the block = kLanes * sum_l b_l - sum_l l * a_l with b_l the lane's own running second sum. Words of
  // even and of odd lanes are the halves of 32-bit words, which need no widening.
  size_t i = 0;
  while (words - i >= kLanes) {
    const size_t rows = std::min(kBlock, (words - i) / kLanes);
    Vector a[2] = {}, b[2] = {};
    for (size_t r = 0; r < rows; ++r) {
      Vector w;
      std::memcpy(&w, p + 2 * (i + r * kLanes), sizeof w);
      a[0] += w & 0xffff;
      b[0] += a[0];
      a[1] += w >> 16;
      b[1] += a[1];
    }
    uint64_t block1 = 0, block2 = 0;
    for (size_t l = 0; l < kLanes; ++l) {
      block1 += a[l % 2][l / 2];
      block2 += kLanes * uint64_t{b[l % 2][l / 2]} - l * uint64_t{a[l % 2][l / 2]};
    }
    s2 = (s2 + s1 * (rows * kLanes) + block2) % 65535;
    s1 = (s1 + block1) % 65535;
    i += rows * kLanes;
  }
  for (; i < words; ++i) {
    uint16_t w;
    std::memcpy(&w, p + 2 * i, 2);
    s1 += w;
    s2 += s1;
  }
  // Swapping the bytes of a word is multiplying it by 256 modulo 65535 (2^16 = 1).
  s1 = s1 % 65535 * 256;
  s2 = s2 % 65535 * 256;
  if (size % 2 != 0) {
    s1 += uint64_t{p[size - 1]} << 8;
    s2 += s1;
  }
  // "All zero" and "a multiple of 65535" differ in HDF5; only non-zero data can give the second.
  if (s1 % 65535 == 0 || s2 % 65535 == 0) {
    const bool zero = std::all_of(p, p + size, [](unsigned char c) { return c == 0; });
    if (zero) return 0;
    if (s1 % 65535 == 0) s1 = 65535;
    if (s2 % 65535 == 0) s2 = 65535;
  }
  return reduce(s2) << 16 | reduce(s1);
}

}  // namespace truestep
