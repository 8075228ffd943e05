// Loads by lists of neighbours: numbers and rows of four numbers at indices that follow one another in
// memory, and the bits of a comparison.
#pragma once
#include <cstddef>
#include <cstdint>

#include "engine/math/wide.h"

namespace truestep::sph {

/// Lane i: numbers[index[i]].
template <class T>
inline Wide<T> gather(const T* numbers, const uint32_t* index) {
  Wide<T> out;
  for (int i = 0; i < Wide<T>::kLanes; ++i) out.v[i] = numbers[index[i]];
  return out;
}

/// out[k] lane i: rows[4 index[i] + k], rows 16-byte (float) or 32-byte (double) aligned.
template <class T>
inline void gather_rows4(const T* rows, const uint32_t* index, Wide<T> out[4]) {
#if defined(__AVX2__) && defined(__FMA__)
  using Raw = typename Wide<T>::Raw;
  const auto row = [&](int i) { return rows + 4 * static_cast<size_t>(index[i]); };
  if constexpr (sizeof(T) == 4) {
    __m256 r[4];
    for (int i = 0; i < 4; ++i) {
      r[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(row(i))), _mm_load_ps(row(i + 4)), 1);
    }
    const __m256 a = _mm256_unpacklo_ps(r[0], r[1]), b = _mm256_unpackhi_ps(r[0], r[1]);
    const __m256 c = _mm256_unpacklo_ps(r[2], r[3]), d = _mm256_unpackhi_ps(r[2], r[3]);
    out[0].v = Raw(_mm256_shuffle_ps(a, c, 0x44)), out[1].v = Raw(_mm256_shuffle_ps(a, c, 0xee));
    out[2].v = Raw(_mm256_shuffle_ps(b, d, 0x44)), out[3].v = Raw(_mm256_shuffle_ps(b, d, 0xee));
  } else {
    __m256d r[4];
    for (int i = 0; i < 4; ++i) r[i] = _mm256_load_pd(row(i));
    wide_detail::transpose(r[0], r[1], r[2], r[3]);
    for (int i = 0; i < 4; ++i) out[i].v = Raw(r[i]);
  }
#else
  for (int i = 0; i < Wide<T>::kLanes; ++i) {
    for (int k = 0; k < 4; ++k)
      out[k].v[i] = rows[4 * static_cast<size_t>(index[i]) + static_cast<size_t>(k)];
  }
#endif
}

/// Bit i: a < b in lane i.
template <class T>
inline uint32_t bits_below(const Wide<T>& a, const Wide<T>& b) {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    return static_cast<uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(__m256(a.v), __m256(b.v), _CMP_LT_OQ)));
  } else {
    return static_cast<uint32_t>(_mm256_movemask_pd(_mm256_cmp_pd(__m256d(a.v), __m256d(b.v), _CMP_LT_OQ)));
  }
#else
  uint32_t bits = 0;
  for (int i = 0; i < Wide<T>::kLanes; ++i) bits |= static_cast<uint32_t>(a.v[i] < b.v[i]) << i;
  return bits;
#endif
}

/// Lanes from first to last, added in that order of a tree that does not depend on anything.
template <class T>
inline T sum(const Wide<T>& a) {
  if constexpr (Wide<T>::kLanes == 8) {
    return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
  } else {
    return (a[0] + a[2]) + (a[1] + a[3]);
  }
}

template <class T>
inline Wide<T> load(const T* p) {
  typename Wide<T>::Raw r;
  __builtin_memcpy(&r, p, sizeof r);
  return {r};
}
template <class T>
inline void store(T* p, const Wide<T>& a) {
  __builtin_memcpy(p, &a.v, sizeof a.v);
}

}  // namespace truestep::sph
