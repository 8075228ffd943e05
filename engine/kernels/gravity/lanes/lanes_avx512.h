// Eight doubles and sixteen floats side by side, for processors with AVX-512. Included inside a namespace of
// its own; the same names and bits as lanes_plain.h.
struct Doubles {
  using Number = double;
  __m512d v;
  static Doubles all(double s) { return {_mm512_set1_pd(s)}; }
  static Doubles load(const double* p) { return {_mm512_loadu_pd(p)}; }
  void store(double* p) const { _mm512_storeu_pd(p, v); }
  friend Doubles operator+(Doubles a, Doubles b) { return {_mm512_add_pd(a.v, b.v)}; }
  friend Doubles operator-(Doubles a, Doubles b) { return {_mm512_sub_pd(a.v, b.v)}; }
  friend Doubles operator*(Doubles a, Doubles b) { return {_mm512_mul_pd(a.v, b.v)}; }
  friend Doubles madd(Doubles a, Doubles b, Doubles c) { return {_mm512_fmadd_pd(a.v, b.v, c.v)}; }
  friend Doubles nmadd(Doubles a, Doubles b, Doubles c) { return {_mm512_fnmadd_pd(a.v, b.v, c.v)}; }
  /// x > y ? a : b.
  friend Doubles where_above(Doubles x, Doubles y, Doubles a, Doubles b) {
    return {_mm512_mask_blend_pd(_mm512_cmp_pd_mask(x.v, y.v, _CMP_GT_OQ), b.v, a.v)};
  }
  /// magic - bits / 2.
  friend Doubles halved_exponent(Doubles a, uint64_t magic) {
    return {_mm512_castsi512_pd(_mm512_sub_epi64(_mm512_set1_epi64(static_cast<long long>(magic)),
                                                 _mm512_srli_epi64(_mm512_castpd_si512(a.v), 1)))};
  }
};

struct Floats {
  using Number = float;
  __m512 v;
  static Floats all(float s) { return {_mm512_set1_ps(s)}; }
  static Floats load(const float* p) { return {_mm512_loadu_ps(p)}; }
  void store(float* p) const { _mm512_storeu_ps(p, v); }
  friend Floats operator+(Floats a, Floats b) { return {_mm512_add_ps(a.v, b.v)}; }
  friend Floats operator-(Floats a, Floats b) { return {_mm512_sub_ps(a.v, b.v)}; }
  friend Floats operator*(Floats a, Floats b) { return {_mm512_mul_ps(a.v, b.v)}; }
  friend Floats madd(Floats a, Floats b, Floats c) { return {_mm512_fmadd_ps(a.v, b.v, c.v)}; }
  friend Floats nmadd(Floats a, Floats b, Floats c) { return {_mm512_fnmadd_ps(a.v, b.v, c.v)}; }
  friend Floats where_above(Floats x, Floats y, Floats a, Floats b) {
    return {_mm512_mask_blend_ps(_mm512_cmp_ps_mask(x.v, y.v, _CMP_GT_OQ), b.v, a.v)};
  }
  friend Floats halved_exponent(Floats a, uint32_t magic) {
    return {_mm512_castsi512_ps(_mm512_sub_epi32(_mm512_set1_epi32(static_cast<int>(magic)),
                                                 _mm512_srli_epi32(_mm512_castps_si512(a.v), 1)))};
  }
};
