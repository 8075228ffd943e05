// Loads by lists of neighbours: numbers and rows of four numbers at indices that follow one another in
// memory, and the bits of a comparison.
#pragma once
#include <cstddef>
#include <cstdint>

#include "engine/math/wide.h"

namespace truestep::sph {

/// Lane i: numbers[index[i]].
template <class T, class Index>
inline Wide<T> gather(const T* numbers, const Index* index) {
  Wide<T> out;
  for (int i = 0; i < Wide<T>::kLanes; ++i) out.v[i] = numbers[index[i]];
  return out;
}

/// out[k] lane i: rows[4 index[i] + k], rows 16-byte (float) or 32-byte (double) aligned.
template <class T, class Index>
inline void gather_rows4(const T* rows, const Index* index, Wide<T> out[4]) {
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
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    const __m256 all = __m256(a.v);
    const __m128 four = _mm_add_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
    const __m128 two = _mm_add_ps(four, _mm_movehl_ps(four, four));
    return _mm_cvtss_f32(_mm_add_ss(two, _mm_shuffle_ps(two, two, 1)));
  } else {
    const __m256d all = __m256d(a.v);
    const __m128d two = _mm_add_pd(_mm256_castpd256_pd128(all), _mm256_extractf128_pd(all, 1));
    return _mm_cvtsd_f64(_mm_add_sd(two, _mm_unpackhi_pd(two, two)));
  }
#else
  if constexpr (Wide<T>::kLanes == 8) {
    return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
  } else {
    return (a[0] + a[2]) + (a[1] + a[3]);
  }
#endif
}

/// For each set of lanes its members, from the lowest on.
struct LaneTable {
  uint8_t of[256][8] = {};
  constexpr LaneTable() {
    for (unsigned bits = 0; bits < 256; ++bits) {
      int count = 0;
      for (uint8_t lane = 0; lane < 8; ++lane) {
        if (bits >> lane & 1) of[bits][count++] = lane;
      }
    }
  }
};
inline constexpr LaneTable kLanesOf;

/// Stores of those lanes alone whose bits are set, side by side; what is behind them, up to a whole Wide, is
/// overwritten.
template <class T>
class LanesOf {
 public:
  explicit LanesOf(uint32_t bits) : bits_(bits) {
#if defined(__AVX2__) && defined(__FMA__)
    if constexpr (sizeof(T) == 4) {
      order_ = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(kLanesOf.of[bits])));
    }
#endif
  }
  size_t count() const {
    return static_cast<size_t>(__builtin_popcount(bits_));
  }
  void store(T* out, const Wide<T>& a) const {
#if defined(__AVX2__) && defined(__FMA__)
    if constexpr (sizeof(T) == 4) {
      _mm256_storeu_ps(out, _mm256_permutevar8x32_ps(__m256(a.v), order_));
      return;
    }
#endif
    const uint8_t* lanes = kLanesOf.of[bits_];
    for (size_t k = 0; k < count(); ++k) out[k] = a.v[lanes[k]];
  }
  /// Their numbers, counted from `first` on.
  void store_places(uint32_t* out, uint32_t first) const {
#if defined(__AVX2__) && defined(__FMA__)
    if constexpr (sizeof(T) == 4) {
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                          _mm256_add_epi32(order_, _mm256_set1_epi32(static_cast<int>(first))));
      return;
    }
#endif
    const uint8_t* lanes = kLanesOf.of[bits_];
    for (size_t k = 0; k < count(); ++k) out[k] = first + lanes[k];
  }

 private:
  uint32_t bits_;
#if defined(__AVX2__) && defined(__FMA__)
  __m256i order_ = {};
#endif
};

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

/// The nearest whole numbers, halves to even ones; |a| below 2^22 (float) or 2^51 (double).
template <class T>
inline Wide<T> nearest(const Wide<T>& a) {
  const Wide<T> shift = Wide<T>::all(static_cast<T>(sizeof(T) == 4 ? 0x1.8p23 : 0x1.8p52));
  return (a + shift) - shift;
}

/// Loads and stores of numbers that are kept as they are, or of whole ones of 16 bits.
template <class T>
inline Wide<T> load_as(const T* p) {
  return load(p);
}
template <class T>
inline void store_as(T* p, const Wide<T>& a) {
  store(p, a);
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
inline void store_as(int16_t* p, const Wide<float>& a) {
#if defined(__AVX2__) && defined(__FMA__)
  const __m256i whole = _mm256_cvttps_epi32(__m256(a.v));
  const __m128i r = _mm_packs_epi32(_mm256_castsi256_si128(whole), _mm256_extracti128_si256(whole, 1));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(p), r);
#else
  const EightShorts r = __builtin_convertvector(a.v, EightShorts);
  __builtin_memcpy(p, &r, sizeof r);
#endif
}

}  // namespace truestep::sph
