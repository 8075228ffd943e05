// 32 bytes of numbers side by side: eight floats or four doubles, one IEEE operation per lane, the same bits
// with and without AVX2. For solvers that are templates over the scalar and gather rows of eight numbers.
#pragma once
#include <cmath>
#include <cstdint>
#include <type_traits>

#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace truestep {

namespace wide_detail {
// Not members of the template: gcc 12 confuses a dependent type with the attribute with one without it.
template <class T>
struct Vectors;
template <>
struct Vectors<float> {
  typedef float Raw __attribute__((vector_size(32)));
  typedef int32_t Mask __attribute__((vector_size(32)));
};
template <>
struct Vectors<double> {
  typedef double Raw __attribute__((vector_size(32)));
  typedef int64_t Mask __attribute__((vector_size(32)));
};
}  // namespace wide_detail

template <class T>
struct Wide {
  static constexpr int kLanes = 32 / sizeof(T);
  using Raw = typename wide_detail::Vectors<T>::Raw;
  using Mask = typename wide_detail::Vectors<T>::Mask;

  Raw v;

  Wide() = default;
  Wide(Raw x) : v(x) {}
  /// The same number in every lane.
  template <class U>
  requires std::is_arithmetic_v<U>
  explicit Wide(U s) : Wide(all(static_cast<T>(s))) {}

  static Wide all(T s) {
#if defined(__AVX2__) && defined(__FMA__)
    // Intrinsics, as gcc turns a loop over the lanes into seven insertions.
    if constexpr (sizeof(T) == 4) {
      return {(Raw)_mm256_set1_ps(s)};
    } else {
      return {(Raw)_mm256_set1_pd(s)};
    }
#else
    Raw r;
    for (int i = 0; i < kLanes; ++i) r[i] = s;
    return {r};
#endif
  }
  static Wide zero() {
    return {Raw{}};
  }
  T operator[](int i) const {
    return v[i];
  }
  void set(int i, T s) {
    v[i] = s;
  }

  friend Wide operator+(Wide a, Wide b) {
    return {a.v + b.v};
  }
  friend Wide operator-(Wide a, Wide b) {
    return {a.v - b.v};
  }
  friend Wide operator*(Wide a, Wide b) {
    return {a.v * b.v};
  }
  friend Wide operator/(Wide a, Wide b) {
    return {a.v / b.v};
  }
  friend Wide operator-(Wide a) {
    return {-a.v};
  }
  Wide& operator+=(Wide b) {
    return *this = *this + b;
  }
  Wide& operator-=(Wide b) {
    return *this = *this - b;
  }
  friend Mask operator>(Wide a, Wide b) {
    return a.v > b.v;
  }
  friend Mask operator<(Wide a, Wide b) {
    return a.v < b.v;
  }

  /// a where the mask is set, b elsewhere.
  friend Wide select(Mask m, Wide a, Wide b) {
    return {m ? a.v : b.v};
  }
  /// The larger; b when they are equal or one is NaN.
  friend Wide max(Wide a, Wide b) {
    return {a.v > b.v ? a.v : b.v};
  }
  friend Wide min(Wide a, Wide b) {
    return {a.v < b.v ? a.v : b.v};
  }

  /// Lane by lane: x > 0 ? a : b.
  friend Wide where_positive(const Wide& x, const Wide& a, const Wide& b) {
    return {x.v > Raw{} ? a.v : b.v};
  }
  friend Wide sqrt(const Wide& a) {
#if defined(__AVX2__) && defined(__FMA__)
    if constexpr (sizeof(T) == 4) {
      return {(Raw)_mm256_sqrt_ps((__m256)a.v)};
    } else {
      return {(Raw)_mm256_sqrt_pd((__m256d)a.v)};
    }
#else
    Wide r;
    for (int i = 0; i < kLanes; ++i) r.v[i] = std::sqrt(a.v[i]);
    return r;
#endif
  }
  /// True when a < b in any lane.
  friend bool any_below(const Wide& a, const Wide& b) {
#if defined(__AVX2__) && defined(__FMA__)
    if constexpr (sizeof(T) == 4) {
      return _mm256_movemask_ps(_mm256_cmp_ps((__m256)a.v, (__m256)b.v, _CMP_LT_OQ));
    } else {
      return _mm256_movemask_pd(_mm256_cmp_pd((__m256d)a.v, (__m256d)b.v, _CMP_LT_OQ));
    }
#else
    for (int i = 0; i < kLanes; ++i) {
      if (a.v[i] < b.v[i]) return true;
    }
    return false;
#endif
  }
  Wide& operator*=(Wide b) {
    return *this = *this * b;
  }

#if defined(__AVX2__) && defined(__FMA__)
  /// a b + c, rounded once.
  friend Wide madd(Wide a, Wide b, Wide c) {
    if constexpr (sizeof(T) == 4) {
      return {(Raw)_mm256_fmadd_ps((__m256)a.v, (__m256)b.v, (__m256)c.v)};
    } else {
      return {(Raw)_mm256_fmadd_pd((__m256d)a.v, (__m256d)b.v, (__m256d)c.v)};
    }
  }
  /// c - a b, rounded once.
  friend Wide nmadd(Wide a, Wide b, Wide c) {
    if constexpr (sizeof(T) == 4) {
      return {(Raw)_mm256_fnmadd_ps((__m256)a.v, (__m256)b.v, (__m256)c.v)};
    } else {
      return {(Raw)_mm256_fnmadd_pd((__m256d)a.v, (__m256d)b.v, (__m256d)c.v)};
    }
  }
#else
  friend Wide madd(Wide a, Wide b, Wide c) {
    for (int i = 0; i < kLanes; ++i) c.v[i] = std::fma(a.v[i], b.v[i], c.v[i]);
    return c;
  }
  friend Wide nmadd(Wide a, Wide b, Wide c) {
    for (int i = 0; i < kLanes; ++i) c.v[i] = std::fma(-a.v[i], b.v[i], c.v[i]);
    return c;
  }
#endif
};

/// Rows of eight numbers, 32-byte aligned (float) or 64-byte (double): out[k][i] = rows[8 index[i] + k].
template <class T>
inline void gather_rows8(const T* rows, const uint32_t* index, Wide<T> out[8]) {
  for (int k = 0; k < 8; ++k) {
    for (int i = 0; i < Wide<T>::kLanes; ++i) out[k].v[i] = rows[8 * static_cast<size_t>(index[i]) + k];
  }
}
/// The first four numbers of the rows whose index is below `limit`: rows[8 index[i] + k] = in[k][i].
template <class T>
inline void scatter_rows4(T* rows, const uint32_t* index, uint32_t limit, const Wide<T> in[4]) {
  for (int i = 0; i < Wide<T>::kLanes; ++i) {
    if (index[i] >= limit) continue;
    for (int k = 0; k < 4; ++k) rows[8 * static_cast<size_t>(index[i]) + k] = in[k].v[i];
  }
}

#if defined(__AVX2__) && defined(__FMA__)
namespace wide_detail {
inline void transpose(__m256d& a, __m256d& b, __m256d& c, __m256d& d) {
  const __m256d ab0 = _mm256_unpacklo_pd(a, b), ab1 = _mm256_unpackhi_pd(a, b);
  const __m256d cd0 = _mm256_unpacklo_pd(c, d), cd1 = _mm256_unpackhi_pd(c, d);
  a = _mm256_permute2f128_pd(ab0, cd0, 0x20), b = _mm256_permute2f128_pd(ab1, cd1, 0x20);
  c = _mm256_permute2f128_pd(ab0, cd0, 0x31), d = _mm256_permute2f128_pd(ab1, cd1, 0x31);
}
}  // namespace wide_detail

template <>
inline void gather_rows8<float>(const float* rows, const uint32_t* index, Wide<float> out[8]) {
  __m256 r[8], s[8];
  for (int i = 0; i < 8; ++i) r[i] = _mm256_load_ps(rows + 8 * static_cast<size_t>(index[i]));
  for (int i = 0; i < 4; ++i) {
    s[2 * i] = _mm256_unpacklo_ps(r[2 * i], r[2 * i + 1]);
    s[2 * i + 1] = _mm256_unpackhi_ps(r[2 * i], r[2 * i + 1]);
  }
  for (int i = 0; i < 2; ++i) {
    r[4 * i] = _mm256_shuffle_ps(s[4 * i], s[4 * i + 2], 0x44);
    r[4 * i + 1] = _mm256_shuffle_ps(s[4 * i], s[4 * i + 2], 0xee);
    r[4 * i + 2] = _mm256_shuffle_ps(s[4 * i + 1], s[4 * i + 3], 0x44);
    r[4 * i + 3] = _mm256_shuffle_ps(s[4 * i + 1], s[4 * i + 3], 0xee);
  }
  for (int i = 0; i < 4; ++i) {
    out[i].v = (Wide<float>::Raw)_mm256_permute2f128_ps(r[i], r[i + 4], 0x20);
    out[i + 4].v = (Wide<float>::Raw)_mm256_permute2f128_ps(r[i], r[i + 4], 0x31);
  }
}

template <>
inline void gather_rows8<double>(const double* rows, const uint32_t* index, Wide<double> out[8]) {
  for (int half = 0; half < 2; ++half) {
    __m256d r[4];
    for (int i = 0; i < 4; ++i) r[i] = _mm256_load_pd(rows + 8 * static_cast<size_t>(index[i]) + 4 * half);
    wide_detail::transpose(r[0], r[1], r[2], r[3]);
    for (int i = 0; i < 4; ++i) out[4 * half + i].v = (Wide<double>::Raw)r[i];
  }
}

template <>
inline void scatter_rows4<float>(float* rows, const uint32_t* index, uint32_t limit,
                                 const Wide<float> in[4]) {
  const auto a = (__m256)in[0].v, b = (__m256)in[1].v, c = (__m256)in[2].v, d = (__m256)in[3].v;
  const __m256 ab0 = _mm256_unpacklo_ps(a, b), ab1 = _mm256_unpackhi_ps(a, b);
  const __m256 cd0 = _mm256_unpacklo_ps(c, d), cd1 = _mm256_unpackhi_ps(c, d);
  const __m256 r[4] = {_mm256_shuffle_ps(ab0, cd0, 0x44), _mm256_shuffle_ps(ab0, cd0, 0xee),
                       _mm256_shuffle_ps(ab1, cd1, 0x44), _mm256_shuffle_ps(ab1, cd1, 0xee)};
  for (int i = 0; i < 4; ++i) {
    if (index[i] < limit)
      _mm_store_ps(rows + 8 * static_cast<size_t>(index[i]), _mm256_castps256_ps128(r[i]));
  }
  for (int i = 0; i < 4; ++i) {
    if (index[i + 4] < limit)
      _mm_store_ps(rows + 8 * static_cast<size_t>(index[i + 4]), _mm256_extractf128_ps(r[i], 1));
  }
}

template <>
inline void scatter_rows4<double>(double* rows, const uint32_t* index, uint32_t limit,
                                  const Wide<double> in[4]) {
  __m256d r[4] = {(__m256d)in[0].v, (__m256d)in[1].v, (__m256d)in[2].v, (__m256d)in[3].v};
  wide_detail::transpose(r[0], r[1], r[2], r[3]);
  for (int i = 0; i < 4; ++i) {
    if (index[i] < limit) _mm256_store_pd(rows + 8 * static_cast<size_t>(index[i]), r[i]);
  }
}
#endif

/// Eight numbers of a body, contiguous, so that bodies are loaded and stored whole.
template <class T>
struct alignas(32) Record8 {
  T x[8] = {};
};

namespace wide_detail {
#if defined(__AVX2__) && defined(__FMA__)
/// Rows to columns of an 8 x 8 matrix.
inline void transpose8(__m256 r[8]) {
  __m256 t[8], u[8];
  for (int k = 0; k < 8; k += 2) {
    t[k] = _mm256_unpacklo_ps(r[k], r[k + 1]), t[k + 1] = _mm256_unpackhi_ps(r[k], r[k + 1]);
  }
  for (int k = 0; k < 8; k += 4) {
    u[k] = _mm256_shuffle_ps(t[k], t[k + 2], 0x44), u[k + 1] = _mm256_shuffle_ps(t[k], t[k + 2], 0xee);
    u[k + 2] = _mm256_shuffle_ps(t[k + 1], t[k + 3], 0x44);
    u[k + 3] = _mm256_shuffle_ps(t[k + 1], t[k + 3], 0xee);
  }
  for (int k = 0; k < 4; ++k) {
    r[k] = _mm256_permute2f128_ps(u[k], u[k + 4], 0x20),
    r[k + 4] = _mm256_permute2f128_ps(u[k], u[k + 4], 0x31);
  }
}
/// Rows to columns of a 4 x 4 matrix.
inline void transpose4(__m256d r[4]) {
  const __m256d a = _mm256_unpacklo_pd(r[0], r[1]), b = _mm256_unpackhi_pd(r[0], r[1]);
  const __m256d c = _mm256_unpacklo_pd(r[2], r[3]), d = _mm256_unpackhi_pd(r[2], r[3]);
  r[0] = _mm256_permute2f128_pd(a, c, 0x20), r[1] = _mm256_permute2f128_pd(b, d, 0x20);
  r[2] = _mm256_permute2f128_pd(a, c, 0x31), r[3] = _mm256_permute2f128_pd(b, d, 0x31);
}
#endif
}  // namespace wide_detail

/// out[k] lane j = records[index[j]].x[k] for the first six numbers.
template <class T>
[[gnu::always_inline]] inline void gather6(const Record8<T>* records, const uint32_t* index, Wide<T> out[6]) {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    __m256 r[8];
    for (int j = 0; j < 8; ++j) r[j] = _mm256_load_ps(records[index[j]].x);
    wide_detail::transpose8(r);
    for (int k = 0; k < 6; ++k) out[k].v = typename Wide<T>::Raw(r[k]);
  } else {
    __m256d r[4], s[4];
    for (int j = 0; j < 4; ++j) {
      r[j] = _mm256_load_pd(records[index[j]].x), s[j] = _mm256_load_pd(records[index[j]].x + 4);
    }
    wide_detail::transpose4(r), wide_detail::transpose4(s);
    for (int k = 0; k < 4; ++k) out[k].v = typename Wide<T>::Raw(r[k]);
    for (int k = 0; k < 2; ++k) out[4 + k].v = typename Wide<T>::Raw(s[k]);
  }
#else
  for (int j = 0; j < Wide<T>::kLanes; ++j) {
    for (int k = 0; k < 6; ++k) out[k].set(j, records[index[j]].x[k]);
  }
#endif
}

/// records[index[j]].x[k] = in[k] lane j for the first six numbers (the others become 0), unless
/// index[j] >= end.
template <class T>
[[gnu::always_inline]] inline void scatter6(Record8<T>* records, const uint32_t* index, uint32_t end,
                                            const Wide<T> in[6]) {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    __m256 r[8];
    for (int k = 0; k < 6; ++k) r[k] = __m256(in[k].v);
    r[6] = r[7] = _mm256_setzero_ps();
    wide_detail::transpose8(r);
    for (int j = 0; j < 8; ++j) {
      if (index[j] < end) _mm256_store_ps(records[index[j]].x, r[j]);
    }
  } else {
    __m256d r[4], s[4];
    for (int k = 0; k < 4; ++k) r[k] = __m256d(in[k].v);
    for (int k = 0; k < 2; ++k) s[k] = __m256d(in[4 + k].v);
    s[2] = s[3] = _mm256_setzero_pd();
    wide_detail::transpose4(r), wide_detail::transpose4(s);
    for (int j = 0; j < 4; ++j) {
      if (index[j] >= end) continue;
      _mm256_store_pd(records[index[j]].x, r[j]), _mm256_store_pd(records[index[j]].x + 4, s[j]);
    }
  }
#else
  for (int j = 0; j < Wide<T>::kLanes; ++j) {
    if (index[j] >= end) continue;
    for (int k = 0; k < 8; ++k) records[index[j]].x[k] = k < 6 ? in[k][j] : T(0);
  }
#endif
}

}  // namespace truestep
