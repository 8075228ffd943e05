// Rows of four numbers (x, y, z, w) read into and written from lanes: out[k][i] = rows[4 index[i] + k]. For
// solvers that visit points in the order of their constraints, one row per point.
#pragma once
#include <cstddef>
#include <cstdint>

#include "engine/math/wide.h"

namespace truestep {

/// `index` holds a row per lane.
template <class T>
inline void gather_rows4(const T* rows, const uint32_t* index, Wide<T> out[4]) {
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < Wide<T>::kLanes; ++i) out[k].v[i] = rows[4 * static_cast<size_t>(index[i]) + k];
  }
}
/// Writes whole rows. Lanes with one index must hold the same numbers.
template <class T>
inline void scatter_rows4(T* rows, const uint32_t* index, const Wide<T> in[4]) {
  for (int i = 0; i < Wide<T>::kLanes; ++i) {
    for (int k = 0; k < 4; ++k) rows[4 * static_cast<size_t>(index[i]) + k] = in[k].v[i];
  }
}

#if defined(__AVX2__) && defined(__FMA__)
namespace wide_detail {
// Four rows in each half: lanes 0..3 in the low halves, 4..7 in the high ones. Its own inverse.
inline void transpose(__m256& a, __m256& b, __m256& c, __m256& d) {
  const __m256 ab0 = _mm256_unpacklo_ps(a, b), ab1 = _mm256_unpackhi_ps(a, b);
  const __m256 cd0 = _mm256_unpacklo_ps(c, d), cd1 = _mm256_unpackhi_ps(c, d);
  a = _mm256_shuffle_ps(ab0, cd0, 0x44), b = _mm256_shuffle_ps(ab0, cd0, 0xee);
  c = _mm256_shuffle_ps(ab1, cd1, 0x44), d = _mm256_shuffle_ps(ab1, cd1, 0xee);
}
}  // namespace wide_detail

template <>
inline void gather_rows4<float>(const float* rows, const uint32_t* index, Wide<float> out[4]) {
  __m256 r[4];
  for (int i = 0; i < 4; ++i) {
    r[i] =
        _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(rows + 4 * static_cast<size_t>(index[i]))),
                             _mm_loadu_ps(rows + 4 * static_cast<size_t>(index[i + 4])), 1);
  }
  wide_detail::transpose(r[0], r[1], r[2], r[3]);
  for (int k = 0; k < 4; ++k) out[k].v = (Wide<float>::Raw)r[k];
}
template <>
inline void scatter_rows4<float>(float* rows, const uint32_t* index, const Wide<float> in[4]) {
  __m256 r[4];
  for (int k = 0; k < 4; ++k) r[k] = (__m256)in[k].v;
  wide_detail::transpose(r[0], r[1], r[2], r[3]);
  for (int i = 0; i < 4; ++i) {
    _mm_storeu_ps(rows + 4 * static_cast<size_t>(index[i]), _mm256_castps256_ps128(r[i]));
    _mm_storeu_ps(rows + 4 * static_cast<size_t>(index[i + 4]), _mm256_extractf128_ps(r[i], 1));
  }
}
template <>
inline void gather_rows4<double>(const double* rows, const uint32_t* index, Wide<double> out[4]) {
  __m256d r[4];
  for (int i = 0; i < 4; ++i) r[i] = _mm256_loadu_pd(rows + 4 * static_cast<size_t>(index[i]));
  wide_detail::transpose(r[0], r[1], r[2], r[3]);
  for (int k = 0; k < 4; ++k) out[k].v = (Wide<double>::Raw)r[k];
}
template <>
inline void scatter_rows4<double>(double* rows, const uint32_t* index, const Wide<double> in[4]) {
  __m256d r[4];
  for (int k = 0; k < 4; ++k) r[k] = (__m256d)in[k].v;
  wide_detail::transpose(r[0], r[1], r[2], r[3]);
  for (int i = 0; i < 4; ++i) _mm256_storeu_pd(rows + 4 * static_cast<size_t>(index[i]), r[i]);
}
#endif

}  // namespace truestep
