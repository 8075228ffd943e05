// Four doubles side by side, for kernels over 3 x 3 blocks that a compiler would split into pieces of two and
// one. The portable variant gives the same bits: every operation is one IEEE operation per lane.
#pragma once
#include <cstdint>

#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#else
#include <cmath>
#endif

namespace truestep {

#if defined(__AVX2__) && defined(__FMA__)

struct Lanes4 {
  __m256d v;
  static Lanes4 zero() { return {_mm256_setzero_pd()}; }
  static Lanes4 load(const double* p) { return {_mm256_loadu_pd(p)}; }
  void store(double* p) const { _mm256_storeu_pd(p, v); }
  /// this + a * s, rounded once.
  Lanes4 plus(Lanes4 a, double s) const { return {_mm256_fmadd_pd(a.v, _mm256_set1_pd(s), v)}; }
  /// this - a * s, rounded once.
  Lanes4 minus(Lanes4 a, double s) const { return {_mm256_fnmadd_pd(a.v, _mm256_set1_pd(s), v)}; }
  static Lanes4 all(double s) { return {_mm256_set1_pd(s)}; }
  /// p[i[0]], p[i[1]], p[i[2]], p[i[3]].
  static Lanes4 gather(const double* p, const uint32_t* i) {
    return {_mm256_set_pd(p[i[3]], p[i[2]], p[i[1]], p[i[0]])};
  }
  friend Lanes4 operator+(Lanes4 a, Lanes4 b) { return {_mm256_add_pd(a.v, b.v)}; }
  friend Lanes4 operator-(Lanes4 a, Lanes4 b) { return {_mm256_sub_pd(a.v, b.v)}; }
  friend Lanes4 operator*(Lanes4 a, Lanes4 b) { return {_mm256_mul_pd(a.v, b.v)}; }
  friend Lanes4 operator/(Lanes4 a, Lanes4 b) { return {_mm256_div_pd(a.v, b.v)}; }
  friend Lanes4 operator-(Lanes4 a) { return {_mm256_xor_pd(a.v, _mm256_set1_pd(-0.0))}; }
  friend Lanes4 sqrt(Lanes4 a) { return {_mm256_sqrt_pd(a.v)}; }
  /// Bit k is set where lane k of a is below that of b.
  friend unsigned below(Lanes4 a, Lanes4 b) {
    return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)));
  }
};

#else

struct Lanes4 {
  double v[4];
  static Lanes4 zero() { return {}; }
  static Lanes4 load(const double* p) { return {{p[0], p[1], p[2], p[3]}}; }
  void store(double* p) const {
    for (int k = 0; k < 4; ++k) p[k] = v[k];
  }
  Lanes4 plus(Lanes4 a, double s) const {
    Lanes4 r;
    for (int k = 0; k < 4; ++k) r.v[k] = std::fma(a.v[k], s, v[k]);
    return r;
  }
  Lanes4 minus(Lanes4 a, double s) const { return plus(a, -s); }
  static Lanes4 all(double s) { return {{s, s, s, s}}; }
  static Lanes4 gather(const double* p, const uint32_t* i) { return {{p[i[0]], p[i[1]], p[i[2]], p[i[3]]}}; }
  friend Lanes4 operator+(Lanes4 a, Lanes4 b) {
    for (int k = 0; k < 4; ++k) a.v[k] += b.v[k];
    return a;
  }
  friend Lanes4 operator-(Lanes4 a, Lanes4 b) {
    for (int k = 0; k < 4; ++k) a.v[k] -= b.v[k];
    return a;
  }
  friend Lanes4 operator*(Lanes4 a, Lanes4 b) {
    for (int k = 0; k < 4; ++k) a.v[k] *= b.v[k];
    return a;
  }
  friend Lanes4 operator/(Lanes4 a, Lanes4 b) {
    for (int k = 0; k < 4; ++k) a.v[k] /= b.v[k];
    return a;
  }
  friend Lanes4 operator-(Lanes4 a) {
    for (int k = 0; k < 4; ++k) a.v[k] = -a.v[k];
    return a;
  }
  friend Lanes4 sqrt(Lanes4 a) {
    for (int k = 0; k < 4; ++k) a.v[k] = std::sqrt(a.v[k]);
    return a;
  }
  friend unsigned below(Lanes4 a, Lanes4 b) {
    unsigned bits = 0;
    for (int k = 0; k < 4; ++k) bits |= (a.v[k] < b.v[k] ? 1u : 0u) << k;
    return bits;
  }
};

#endif

/// Stores the first three lanes at p; p[3] keeps its value.
inline void store3(const Lanes4& a, double* p) {
  double all[4];
  a.store(all);
  p[0] = all[0], p[1] = all[1], p[2] = all[2];
}

}  // namespace truestep
