// The rows of a range that are within a reach of a position, appended in order: four squared distances at a
// time, with the selected lanes packed to the front by a table of permutations.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/math/vec3.h"
#include "engine/math/wide.h"

namespace truestep::molecular {

namespace near_detail {
/// For every set of four lanes, the source of its i-th lane, in bytes of four uint32_t.
constexpr auto packings() {
  std::array<std::array<uint8_t, 16>, 16> out{};
  for (unsigned set = 0; set < 16; ++set) {
    unsigned to = 0;
    for (uint8_t lane = 0; lane < 4; ++lane) {
      if ((set >> lane & 1) == 0) continue;
      for (uint8_t b = 0; b < 4; ++b) out[set][4 * to + b] = static_cast<uint8_t>(4 * lane + b);
      ++to;
    }
  }
  return out;
}
alignas(16) inline constexpr auto kPackings = packings();
}  // namespace near_detail

/// Positions of rows as columns, m; up to three numbers past the end may be read.
struct PlaceColumns {
  const double *x, *y, *z;
};

/// Appends the rows of [from, to) with |place - at|^2 < reach2 to list[used] on and returns the new count;
/// list needs room for to - from + 4 more.
inline size_t append_near(const PlaceColumns& p, size_t from, size_t to, const Vec3& at, double reach2,
                          uint32_t* list, size_t used) {
#if defined(__AVX2__) && defined(__FMA__)
  const __m256d x = _mm256_set1_pd(at.x), y = _mm256_set1_pd(at.y), z = _mm256_set1_pd(at.z),
                limit = _mm256_set1_pd(reach2);
  __m128i rows = _mm_add_epi32(_mm_set1_epi32(static_cast<int>(from)), _mm_setr_epi32(0, 1, 2, 3));
  for (size_t k = from; k < to; k += 4) {
    const __m256d dx = _mm256_sub_pd(_mm256_loadu_pd(p.x + k), x),
                  dy = _mm256_sub_pd(_mm256_loadu_pd(p.y + k), y),
                  dz = _mm256_sub_pd(_mm256_loadu_pd(p.z + k), z);
    const __m256d r2 = _mm256_fmadd_pd(dz, dz, _mm256_fmadd_pd(dy, dy, _mm256_mul_pd(dx, dx)));
    auto set = static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(r2, limit, _CMP_LT_OQ)));
    if (k + 4 > to) set &= (1u << (to - k)) - 1;
    const auto packing = _mm_load_si128(reinterpret_cast<const __m128i*>(near_detail::kPackings[set].data()));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(list + used), _mm_shuffle_epi8(rows, packing));
    used += static_cast<size_t>(__builtin_popcount(set));
    rows = _mm_add_epi32(rows, _mm_set1_epi32(4));
  }
#else
  for (size_t k = from; k < to; ++k) {
    const double dx = p.x[k] - at.x, dy = p.y[k] - at.y, dz = p.z[k] - at.z;
    list[used] = static_cast<uint32_t>(k);
    used += std::fma(dz, dz, std::fma(dy, dy, dx * dx)) < reach2;
  }
#endif
  return used;
}

}  // namespace truestep::molecular
