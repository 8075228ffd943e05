// Lanes of a Wide: which of them a comparison holds for, those alone stored side by side, and their sum,
// smallest and largest, in a fixed order.
#pragma once
#include <cstddef>
#include <cstdint>

#include "engine/math/wide.h"

namespace truestep::sph {

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

/// Sum of lanes `first` to `last`, added in the fixed order of a tree.
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

/// out[k] = sum(a[k]), of four.
template <class T>
inline void sum_each(const Wide<T> a[4], T out[4]) {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    __m128 four[4];
    for (int k = 0; k < 4; ++k) {
      const __m256 all = __m256(a[k].v);
      four[k] = _mm_add_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
    }
    const __m128 two0 = _mm_add_ps(_mm_unpacklo_ps(four[0], four[1]), _mm_unpackhi_ps(four[0], four[1]));
    const __m128 two2 = _mm_add_ps(_mm_unpacklo_ps(four[2], four[3]), _mm_unpackhi_ps(four[2], four[3]));
    _mm_storeu_ps(out, _mm_add_ps(_mm_movelh_ps(two0, two2), _mm_movehl_ps(two2, two0)));
    return;
  }
#endif
  for (int k = 0; k < 4; ++k) out[k] = sum(a[k]);
}

/// The smallest and the largest of all lanes, in every lane.
template <class T>
inline Wide<T> smallest(const Wide<T>& a) {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    const __m256 all = __m256(a.v), four = _mm256_min_ps(all, _mm256_permute2f128_ps(all, all, 1));
    const __m256 two = _mm256_min_ps(four, _mm256_permute_ps(four, 0x4e));
    return {typename Wide<T>::Raw(_mm256_min_ps(two, _mm256_permute_ps(two, 0xb1)))};
  }
#endif
  T least = a[0];
  for (int i = 1; i < Wide<T>::kLanes; ++i) least = a[i] < least ? a[i] : least;
  return Wide<T>::all(least);
}
template <class T>
inline Wide<T> largest(const Wide<T>& a) {
  return -smallest(-a);
}

/// For each set of lanes, its members in ascending order.
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

/// Stores only the lanes whose bits are set, side by side; memory after them, up to a whole Wide, is
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

 private:
  uint32_t bits_;
#if defined(__AVX2__) && defined(__FMA__)
  __m256i order_ = {};
#endif
};

/// first + lane for those lanes whose bits are set, side by side, and overwrites what is behind them up to
/// Lanes numbers; returns how many are set.
template <size_t Lanes>
inline size_t store_lanes(uint32_t* out, uint32_t first, uint32_t bits) {
  const uint8_t* lanes = kLanesOf.of[bits];
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (Lanes == 8) {
    const __m256i order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(lanes)));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                        _mm256_add_epi32(order, _mm256_set1_epi32(static_cast<int32_t>(first))));
    return static_cast<size_t>(__builtin_popcount(bits));
  }
#endif
  for (size_t k = 0; k < Lanes; ++k) out[k] = first + lanes[k];
  return static_cast<size_t>(__builtin_popcount(bits));
}

/// Bit i: lane i of a comparison holds.
template <class T>
inline uint32_t lanes_set(const typename Wide<T>::Mask& mask) {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    return static_cast<uint32_t>(_mm256_movemask_ps(__m256(mask)));
  } else {
    return static_cast<uint32_t>(_mm256_movemask_pd(__m256d(mask)));
  }
#else
  uint32_t bits = 0;
  for (int i = 0; i < Wide<T>::kLanes; ++i) bits |= static_cast<uint32_t>(mask[i] != 0) << i;
  return bits;
#endif
}
/// Loads consecutive integers.
template <class T>
inline typename Wide<T>::Mask whole(const uint32_t* p) {
  typename Wide<T>::Mask out;
  if constexpr (sizeof(T) == 4) {
    __builtin_memcpy(&out, p, sizeof out);
  } else {
    for (int i = 0; i < Wide<T>::kLanes; ++i) out[i] = p[i];
  }
  return out;
}
/// Lanes below `count`.
template <class T>
inline typename Wide<T>::Mask first_lanes(size_t count) {
  using Mask = typename Wide<T>::Mask;
  if constexpr (sizeof(T) == 4) {
    return Mask{0, 1, 2, 3, 4, 5, 6, 7} < static_cast<int32_t>(count);
  } else {
    return Mask{0, 1, 2, 3} < static_cast<int64_t>(count);
  }
}

}  // namespace truestep::sph
