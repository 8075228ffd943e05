// Loads through neighbour lists: numbers and rows of four numbers at indices stored consecutively, and rows
// of 16-bit numbers.
#pragma once
#include <cstddef>
#include <cstdint>

#include "engine/math/wide.h"

namespace truestep::sph {

/// Where index i finds its row of `Width` numbers: at rows + Width index[i], or where the index itself says.
template <size_t Width, class T, class Index>
[[gnu::always_inline]] inline const T* place_of(const T* rows, const Index& index, size_t i) {
  if constexpr (requires { index.template place<Width>(rows, i); }) {
    return index.template place<Width>(rows, i);
  } else {
    return rows + Width * static_cast<size_t>(index[i]);
  }
}

/// Lane i: numbers[index[i]].
template <class T, class Index>
inline Wide<T> gather(const T* numbers, const Index& index) {
  Wide<T> out;
  for (int i = 0; i < Wide<T>::kLanes; ++i) out.v[i] = *place_of<1>(numbers, index, static_cast<size_t>(i));
  return out;
}

/// out[k] lane i: rows[4 index[i] + k], rows 16-byte (float) or 32-byte (double) aligned.
template <class T, class Index>
inline void gather_rows4(const T* rows, const Index& index, Wide<T> out[4]) {
#if defined(__AVX2__) && defined(__FMA__)
  using Raw = typename Wide<T>::Raw;
  const auto row = [&](int i) { return place_of<4>(rows, index, static_cast<size_t>(i)); };
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
    for (int k = 0; k < 4; ++k) out[k].v[i] = place_of<4>(rows, index, static_cast<size_t>(i))[k];
  }
#endif
}

/// rows[4 i + k] = in[k][i].
template <class T>
inline void put_rows4(T* rows, const Wide<T> in[4]) {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    const auto a = __m256(in[0].v), b = __m256(in[1].v), c = __m256(in[2].v), d = __m256(in[3].v);
    const __m256 ab0 = _mm256_unpacklo_ps(a, b), ab1 = _mm256_unpackhi_ps(a, b);
    const __m256 cd0 = _mm256_unpacklo_ps(c, d), cd1 = _mm256_unpackhi_ps(c, d);
    const __m256 r[4] = {_mm256_shuffle_ps(ab0, cd0, 0x44), _mm256_shuffle_ps(ab0, cd0, 0xee),
                         _mm256_shuffle_ps(ab1, cd1, 0x44), _mm256_shuffle_ps(ab1, cd1, 0xee)};
    for (int i = 0; i < 4; ++i) {
      _mm_storeu_ps(rows + 4 * i, _mm256_castps256_ps128(r[i]));
      _mm_storeu_ps(rows + 4 * i + 16, _mm256_extractf128_ps(r[i], 1));
    }
    return;
  }
#endif
  for (int i = 0; i < Wide<T>::kLanes; ++i) {
    for (int k = 0; k < 4; ++k) rows[4 * i + k] = in[k].v[i];
  }
}

/// Rows of four numbers that one Wide holds side by side.
template <class T>
inline constexpr size_t kRowsSide = Wide<T>::kLanes / 4;

/// The rows of four at index[0] and, of floats, index[1], aligned as for gather_rows4.
template <class T, class Index>
inline Wide<T> rows_side_by_side(const T* rows, const Index& index) {
#if defined(__AVX2__) && defined(__FMA__)
  using Raw = typename Wide<T>::Raw;
  if constexpr (sizeof(T) == 4) {
    return {Raw(_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(place_of<4>(rows, index, 0))),
                                     _mm_load_ps(place_of<4>(rows, index, 1)), 1))};
  } else {
    return {Raw(_mm256_load_pd(place_of<4>(rows, index, 0)))};
  }
#else
  Wide<T> out;
  for (size_t i = 0; i < Wide<T>::kLanes; ++i) out.v[i] = place_of<4>(rows, index, i / 4)[i % 4];
  return out;
#endif
}
/// The numbers at index[0] and, of floats, index[1], each four times.
template <class T, class Index>
inline Wide<T> numbers_by_fours(const T* numbers, const Index& index) {
#if defined(__AVX2__) && defined(__FMA__)
  using Raw = typename Wide<T>::Raw;
  if constexpr (sizeof(T) == 4) {
    return {Raw(_mm256_blend_ps(_mm256_broadcast_ss(place_of<1>(numbers, index, 0)),
                                _mm256_broadcast_ss(place_of<1>(numbers, index, 1)), 0xf0))};
  } else {
    return {Raw(_mm256_broadcast_sd(place_of<1>(numbers, index, 0)))};
  }
#else
  Wide<T> out;
  for (size_t i = 0; i < Wide<T>::kLanes; ++i) out.v[i] = *place_of<1>(numbers, index, i / 4);
  return out;
#endif
}
/// out[k]: sum of number k of the rows of four in a.
template <class T>
inline void sum_rows(const Wide<T>& a, T out[4]) {
  for (int k = 0; k < 4; ++k) {
    if constexpr (sizeof(T) == 4) {
      out[k] = a[k] + a[k + 4];
    } else {
      out[k] = a[k];
    }
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

/// Rounded to the nearest integers, ties to even; |a| below 2^22 (float) or 2^51 (double).
template <class T>
inline Wide<T> nearest(const Wide<T>& a) {
  const Wide<T> shift = Wide<T>::all(static_cast<T>(sizeof(T) == 4 ? 0x1.8p23 : 0x1.8p52));
  return (a + shift) - shift;
}

/// Loads of numbers stored as they are, or as 16-bit integers.
template <class T>
inline Wide<T> load_as(const T* p) {
  return load(p);
}
typedef int16_t EightShorts __attribute__((vector_size(16)));
template <class T>
inline Wide<float> load_as(const int16_t* p) {
#if defined(__AVX2__) && defined(__FMA__)
  const __m128i r = _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
  return {Wide<float>::Raw(_mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(r)))};
#else
  EightShorts r;
  __builtin_memcpy(&r, p, sizeof r);
  return {__builtin_convertvector(r, Wide<float>::Raw)};
#endif
}

/// Lane i of in[k] to and from rows[i][k], k from 0 to 2; the last number of a row is unchanged.
template <class T>
inline void store_rows3(T (*rows)[4], const Wide<T> in[3]) {
  for (int i = 0; i < Wide<T>::kLanes; ++i) {
    for (int k = 0; k < 3; ++k) rows[i][k] = in[k].v[i];
  }
}
inline void store_rows3(int16_t (*rows)[4], const Wide<float> in[3]) {
#if defined(__AVX2__) && defined(__FMA__)
  const auto whole = [&](int k) { return _mm256_cvttps_epi32(__m256(in[k].v)); };
  auto* out = reinterpret_cast<__m256i*>(rows);
  const __m256i xy = _mm256_packs_epi32(whole(0), whole(1)), zz = _mm256_packs_epi32(whole(2), whole(2));
  const __m256i xz = _mm256_unpacklo_epi16(xy, zz), yz = _mm256_unpackhi_epi16(xy, zz);
  // Rows 0, 1, 4, 5 and rows 2, 3, 6, 7.
  const __m256i a = _mm256_unpacklo_epi16(xz, yz), b = _mm256_unpackhi_epi16(xz, yz);
  constexpr int kLast = 0x88;
  const __m256i low = _mm256_permute2x128_si256(a, b, 0x20), high = _mm256_permute2x128_si256(a, b, 0x31);
  _mm256_storeu_si256(out, _mm256_blend_epi16(low, _mm256_loadu_si256(out), kLast));
  _mm256_storeu_si256(out + 1, _mm256_blend_epi16(high, _mm256_loadu_si256(out + 1), kLast));
#else
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 3; ++k) rows[i][k] = static_cast<int16_t>(in[k].v[i]);
  }
#endif
}
/// The same with `last` below 2^16 as the last of each row.
inline void store_rows4(int16_t (*rows)[4], const Wide<float> in[3], const Wide<float>::Mask& last) {
#if defined(__AVX2__) && defined(__FMA__)
  const auto whole = [&](int k) { return _mm256_cvttps_epi32(__m256(in[k].v)); };
  constexpr int kOdd = 0xaa;
  const __m256i xy = _mm256_blend_epi16(whole(0), _mm256_slli_epi32(whole(1), 16), kOdd);
  const __m256i zw = _mm256_blend_epi16(whole(2), _mm256_slli_epi32(__m256i(last), 16), kOdd);
  // Rows 0, 1, 4, 5 and rows 2, 3, 6, 7.
  const __m256i a = _mm256_unpacklo_epi32(xy, zw), b = _mm256_unpackhi_epi32(xy, zw);
  auto* out = reinterpret_cast<__m256i*>(rows);
  _mm256_storeu_si256(out, _mm256_permute2x128_si256(a, b, 0x20));
  _mm256_storeu_si256(out + 1, _mm256_permute2x128_si256(a, b, 0x31));
#else
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 3; ++k) rows[i][k] = static_cast<int16_t>(in[k].v[i]);
    rows[i][3] = static_cast<int16_t>(static_cast<uint16_t>(last[i]));
  }
#endif
}
/// Lane i: the last number of row i, as an unsigned one.
inline Wide<float>::Mask load_last(const int16_t (*rows)[4]) {
#if defined(__AVX2__) && defined(__FMA__)
  const auto* in = reinterpret_cast<const __m256i*>(rows);
  const __m256i low = _mm256_srli_epi64(_mm256_loadu_si256(in), 48);
  const __m256i high = _mm256_srli_epi64(_mm256_loadu_si256(in + 1), 48);
  const __m256 mixed = _mm256_shuffle_ps(_mm256_castsi256_ps(low), _mm256_castsi256_ps(high), 0x88);
  return Wide<float>::Mask(_mm256_permute4x64_epi64(_mm256_castps_si256(mixed), 0xd8));
#else
  Wide<float>::Mask out;
  for (int i = 0; i < 8; ++i) out[i] = static_cast<uint16_t>(rows[i][3]);
  return out;
#endif
}
template <class T>
inline void load_rows3(const T (*rows)[4], Wide<T> out[3]) {
  for (int i = 0; i < Wide<T>::kLanes; ++i) {
    for (int k = 0; k < 3; ++k) out[k].v[i] = rows[i][k];
  }
}
inline void load_rows3(const int16_t (*rows)[4], Wide<float> out[3]) {
#if defined(__AVX2__) && defined(__FMA__)
  const auto* in = reinterpret_cast<const __m256i*>(rows);
  const __m256i low = _mm256_loadu_si256(in), high = _mm256_loadu_si256(in + 1);
  const __m256i a = _mm256_permute2x128_si256(low, high, 0x20),
                b = _mm256_permute2x128_si256(low, high, 0x31);
  const __m256i even = _mm256_unpacklo_epi16(a, b), odd = _mm256_unpackhi_epi16(a, b);
  const __m256i xy = _mm256_unpacklo_epi16(even, odd), z = _mm256_unpackhi_epi16(even, odd);
  const auto wide = [](const __m256i& twice) {
    return Wide<float>::Raw(_mm256_cvtepi32_ps(_mm256_srai_epi32(twice, 16)));
  };
  out[0].v = wide(_mm256_unpacklo_epi16(xy, xy)), out[1].v = wide(_mm256_unpackhi_epi16(xy, xy));
  out[2].v = wide(_mm256_unpacklo_epi16(z, z));
#else
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 3; ++k) out[k].v[i] = static_cast<float>(rows[i][k]);
  }
#endif
}

}  // namespace truestep::sph
