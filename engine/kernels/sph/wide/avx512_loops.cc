// The loops for processors with AVX-512; only this file is compiled for them. It includes nothing that could
// emit a function which others call too. Offsets and squared distances of a list are kept as they are found,
// side by side, and evaluated sixteen at a time; sums are added up by eights, in the order of the plain
// loops.
#include <immintrin.h>

#include "engine/kernels/sph/wide/cell_loops.h"
#include "engine/kernels/sph/wide/sum_loops.h"

namespace truestep::sph {
namespace {

constexpr size_t kLanes = 16;

struct Floats {
  __m512 v;
  static Floats all(float s) { return {_mm512_set1_ps(s)}; }
  static Floats zero() { return {_mm512_setzero_ps()}; }
  static Floats load(const float* p) { return {_mm512_loadu_ps(p)}; }
  /// Lanes of the mask, 0 elsewhere: what is not in the mask is not read.
  static Floats load(__mmask16 m, const float* p) { return {_mm512_maskz_loadu_ps(m, p)}; }
  void store(float* p) const { _mm512_storeu_ps(p, v); }
  /// Lanes of the mask side by side, then zeros.
  void store_packed(__mmask16 m, float* p) const { _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m, v)); }
  friend Floats operator+(Floats a, Floats b) { return {_mm512_add_ps(a.v, b.v)}; }
  friend Floats operator-(Floats a, Floats b) { return {_mm512_sub_ps(a.v, b.v)}; }
  friend Floats operator*(Floats a, Floats b) { return {_mm512_mul_ps(a.v, b.v)}; }
  friend Floats operator/(Floats a, Floats b) { return {_mm512_div_ps(a.v, b.v)}; }
  friend Floats madd(Floats a, Floats b, Floats c) { return {_mm512_fmadd_ps(a.v, b.v, c.v)}; }
  friend Floats max(Floats a, Floats b) { return {_mm512_max_ps(a.v, b.v)}; }
  friend Floats min(Floats a, Floats b) { return {_mm512_min_ps(a.v, b.v)}; }
  friend Floats sqrt(Floats a) { return {_mm512_sqrt_ps(a.v)}; }
  friend __mmask16 operator<(Floats a, Floats b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ); }
  friend Floats select(__mmask16 m, Floats a, Floats b) { return {_mm512_mask_blend_ps(m, b.v, a.v)}; }
  /// Lanes 8 h to 8 h + 7.
  template <int h>
  __m256 half() const {
    return _mm512_extractf32x8_ps(v, h);
  }
  /// Rounded to the nearest integers, ties to even; below 2^22.
  Floats nearest() const {
    const Floats shift = all(0x1.8p23f);
    return (*this + shift) - shift;
  }
};

__mmask16 first_lanes(size_t count) {
  return count < kLanes ? static_cast<__mmask16>((1u << count) - 1) : static_cast<__mmask16>(0xffff);
}
__m512i counting() {
  return _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

template <int D>
size_t around(const ListInput& in) {
  Floats low[D], top[D];
  for (int a = 0; a < D; ++a) low[a] = Floats::all(in.low[a]), top[a] = Floats::all(in.top[a]);
  const Floats limit = Floats::all(in.square);
  size_t count = 0;
  for (size_t r = 0; r < in.run_count; ++r) {
    const SlotRun& run = in.runs[r];
    const size_t end = run.end;
    for (size_t k = run.begin; k < end; k += kLanes) {
      const __mmask16 there = first_lanes(end - k);
      Floats place[D], square = Floats::zero();
      for (int a = 0; a < D; ++a) {
        place[a] = Floats::load(there, in.x[a] + k) + Floats::all(static_cast<float>(run.shift[a]));
        const Floats beyond = max(max(low[a] - place[a], place[a] - top[a]), Floats::zero());
        square = madd(beyond, beyond, square);
      }
      const auto near = static_cast<__mmask16>((square < limit) & there);
      for (int a = 0; a < D; ++a) place[a].store_packed(near, in.around[a] + count);
      const __m512i slots = _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(k)), counting());
      _mm512_storeu_si512(in.around_slots + count, _mm512_maskz_compress_epi32(near, slots));
      count += static_cast<size_t>(__builtin_popcount(near));
    }
  }
  for (int a = 0; a < D; ++a) Floats::all(1e18f).store(in.around[a] + count);
  return count;
}

/// Packs the neighbours of a particle; returns their number.
template <int D>
size_t find(const ListInput& in, size_t count, size_t i, const Found& out) {
  // Local copies: any store might change the originals.
  const Found to = out;
  const uint32_t* const around_slots = in.around_slots;
  const float* around[D];
  Floats here[D];
  for (int a = 0; a < D; ++a) here[a] = Floats::all(in.x[a][i]), around[a] = in.around[a];
  const Floats limit = Floats::all(in.square);
  const __m512i itself = _mm512_set1_epi32(static_cast<int>(i));
  size_t found = 0;
  for (size_t k = 0; k < count; k += kLanes) {
    Floats way[D], square = Floats::zero();
    for (int a = 0; a < D; ++a) {
      way[a] = here[a] - Floats::load(around[a] + k);
      square = madd(way[a], way[a], square);
    }
    const __m512i slots = _mm512_loadu_si512(around_slots + k);
    const __mmask16 near = _mm512_mask_cmpneq_epi32_mask(square < limit, slots, itself);
    for (int a = 0; a < D; ++a) way[a].store_packed(near, to.way[a] + found);
    square.store_packed(near, to.squares + found);
    _mm512_storeu_si512(to.slots + found, _mm512_maskz_compress_epi32(near, slots));
    found += static_cast<size_t>(__builtin_popcount(near));
  }
  return found;
}

/// Two groups of entries; `above` are slots over the first of their group.
void store_groups(int16_t* out, const Floats g[3], __m512i above) {
  const __m512i x = _mm512_cvttps_epi32(g[0].v), y = _mm512_cvttps_epi32(g[1].v),
                z = _mm512_cvttps_epi32(g[2].v);
  constexpr __mmask32 kOdd = 0xaaaaaaaa;
  const __m512i xy = _mm512_mask_blend_epi16(kOdd, x, _mm512_slli_epi32(y, 16));
  const __m512i zw = _mm512_mask_blend_epi16(kOdd, z, _mm512_slli_epi32(above, 17));
  // Of every four entries the first two and the last two.
  const __m512i a = _mm512_unpacklo_epi32(xy, zw), b = _mm512_unpackhi_epi32(xy, zw);
  const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11),
                high = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
  _mm512_storeu_si512(out, _mm512_permutex2var_epi64(a, low, b));
  _mm512_storeu_si512(out + 32, _mm512_permutex2var_epi64(a, high, b));
}

template <Smoothing K, int D, bool Weighted>
size_t lists_with(const ListInput& in, size_t count, size_t first, size_t stop, ListOutput& out) {
  const Floats far = Floats::all(in.square), inverse = Floats::all(in.inverse), one = Floats::all(1);
  const Floats kw = Floats::all(in.kernel_w), ks = Floats::all(in.kernel_s),
               per_unit = Floats::all(in.per_unit);
  const __m512i leaders = _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, 8, 8, 8, 8, 8, 8, 8, 8);
  constexpr size_t kAhead = 16;  // groups
  int16_t* const all_groups = out.groups;
  uint32_t* const base = out.base;
  float *const slopes = out.slopes, *const weights = out.weights, *const distances = out.distances;
  size_t used = out.used, made = 0;
  // The next particle's neighbours are found before this one's are evaluated: a load that spans several
  // recent stores cannot be forwarded from them and would wait.
  size_t next = find<D>(in, count, first, in.found[0]);
  for (size_t i = first; i < stop && made < ListOutput::kMost; ++i, ++made) {
    if (made > 0 && used + count + kLanes > out.room) break;
    const size_t found = next;
    const Found near = in.found[made % 2];
    if (i + 1 < stop) next = find<D>(in, count, i + 1, in.found[(made + 1) % 2]);
    __m256 density = _mm256_setzero_ps(), squares = _mm256_setzero_ps();
    __m256 pull[3] = {_mm256_setzero_ps(), _mm256_setzero_ps(), _mm256_setzero_ps()};
    for (size_t at = 0; at < found; at += kLanes) {
      const __mmask16 inside = first_lanes(found - at);
      const Floats distance2 = select(inside, Floats::load(inside, near.squares + at), far);
      const __m512i slots = _mm512_maskz_loadu_epi32(inside, near.slots + at);
      const __m512i above = _mm512_maskz_sub_epi32(inside, slots, _mm512_permutexvar_epi32(leaders, slots));
      const Floats q = min(sqrt(distance2) * inverse, one);
      const SmoothingLanes<Floats> value = smoothing_of<K, float>(q);
      const size_t entries = found - at > 8 ? 16 : 8;
      // Padding is not quite 0 where the kernel's radius times its inverse is not quite 1.
      const Floats w = select(first_lanes(entries), kw * value.w, Floats::zero()), s = ks * value.s;
      density = _mm256_add_ps(_mm256_add_ps(density, w.half<0>()), w.half<1>());
      Floats g[3] = {Floats::zero(), Floats::zero(), Floats::zero()}, square = Floats::zero();
      for (int a = 0; a < D; ++a) {
        g[a] = (s * Floats::load(inside, near.way[a] + at) * per_unit).nearest();
        pull[a] = _mm256_add_ps(_mm256_add_ps(pull[a], g[a].half<0>()), g[a].half<1>());
        if constexpr (Weighted) square = madd(g[a], g[a], square);
      }
      if constexpr (Weighted) {
        const Floats light = {_mm512_mask_i32gather_ps(_mm512_setzero_ps(), inside, slots, in.light, 4)};
        squares = _mm256_fmadd_ps(square.half<0>(), light.half<0>(), squares);
        squares = _mm256_fmadd_ps(square.half<1>(), light.half<1>(), squares);
      } else {
        for (int a = 0; a < D; ++a) squares = _mm256_fmadd_ps(g[a].half<0>(), g[a].half<0>(), squares);
        for (int a = 0; a < D; ++a) squares = _mm256_fmadd_ps(g[a].half<1>(), g[a].half<1>(), squares);
      }
      int16_t* const groups = all_groups + 4 * used;
      // Lists are written to memory that is seldom cached.
      __builtin_prefetch(groups + 32 * kAhead, 1), __builtin_prefetch(groups + 32 * (kAhead + 1), 1);
      store_groups(groups, g, above);
      base[used / 8] = near.slots[at], base[used / 8 + 1] = near.slots[at + 8];
      if (slopes) s.store(slopes + used);
      if (weights) w.store(weights + used);
      if (distances) q.store(distances + used);
      used += entries;
    }
    ListSums& sums = out.sums[made];
    _mm256_storeu_ps(sums.density, density), _mm256_storeu_ps(sums.squares, squares);
    for (int a = 0; a < 3; ++a) _mm256_storeu_ps(sums.pull[a], pull[a]);
    out.ends[made] = static_cast<uint32_t>(used);
  }
  out.used = used;
  return made;
}

template <Smoothing K, int D>
size_t lists(const ListInput& in, size_t count, size_t first, size_t stop, ListOutput& out) {
  return in.light ? lists_with<K, D, true>(in, count, first, stop, out)
                  : lists_with<K, D, false>(in, count, first, stop, out);
}

template <Smoothing K>
constexpr CellLoops kLoops[2] = {{around<2>, lists<K, 2>}, {around<3>, lists<K, 3>}};

/// Gradients of four entries.
Floats gradients_of(const int16_t* entries) {
  return {_mm512_cvtepi32_ps(
      _mm512_cvtepi16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(entries))))};
}
/// The row of `Width` floats of an entry's slot.
template <size_t Width>
const float* place_of(const float* rows, const int16_t* entry) {
  return reinterpret_cast<const float*>(reinterpret_cast<const char*>(rows) +
                                        Width * 2 * static_cast<size_t>(static_cast<uint16_t>(entry[3])));
}
/// The numbers at the slots of four entries, each four times.
Floats numbers_of(const float* numbers, const int16_t* entries) {
  __m512 out = _mm512_broadcastss_ps(_mm_load_ss(place_of<1>(numbers, entries)));
  out = _mm512_mask_broadcastss_ps(out, 0x00f0, _mm_load_ss(place_of<1>(numbers, entries + 4)));
  out = _mm512_mask_broadcastss_ps(out, 0x0f00, _mm_load_ss(place_of<1>(numbers, entries + 8)));
  return {_mm512_mask_broadcastss_ps(out, 0xf000, _mm_load_ss(place_of<1>(numbers, entries + 12)))};
}
/// The rows at the slots of four entries.
Floats rows_of(const float* rows, const int16_t* entries) {
  __m512 out = _mm512_castps128_ps512(_mm_load_ps(place_of<4>(rows, entries)));
  out = _mm512_mask_broadcast_f32x4(out, 0x00f0, _mm_load_ps(place_of<4>(rows, entries + 4)));
  out = _mm512_mask_broadcast_f32x4(out, 0x0f00, _mm_load_ps(place_of<4>(rows, entries + 8)));
  return {_mm512_mask_broadcast_f32x4(out, 0xf000, _mm_load_ps(place_of<4>(rows, entries + 12)))};
}

/// store(particle, the eight lanes of its sum of gradients times factor(slot of a group's first, entries)).
template <class Factor, class Store>
void sum_lists(const ListView& in, size_t count, const Factor& factor, const Store& store) {
  constexpr size_t kAhead = 16;  // groups; lists are larger than the caches
  const int16_t* const groups = in.groups;
  const uint32_t *const base = in.base, *const first = in.first;
  size_t k = first[0] / 8;
  for (size_t i = 0; i < count; ++i) {
    const size_t end = first[i + 1] / 8;
    // Of the first and of the last four entries of each group.
    Floats low = Floats::zero(), high = Floats::zero();
    for (; k != end; ++k) {
      const int16_t* const group = groups + 32 * k;
      __builtin_prefetch(group + 32 * kAhead);
      const size_t from = base[k];
      low = madd(gradients_of(group), factor(from, group), low);
      high = madd(gradients_of(group + 16), factor(from, group + 16), high);
    }
    store(i, _mm256_add_ps(_mm256_add_ps(low.half<0>(), low.half<1>()),
                           _mm256_add_ps(high.half<0>(), high.half<1>())));
  }
}
__m128 sum_halves(__m256 a) {
  return _mm_add_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
}

void sum_times(const ListView& in, size_t count, const float* numbers, float* out) {
  sum_lists(
      in, count,
      [numbers](size_t from, const int16_t* entries) { return numbers_of(numbers + from, entries); },
      [out](size_t i, __m256 sum) { _mm_storeu_ps(out + 4 * i, sum_halves(sum)); });
}
void sum_dot(const ListView& in, size_t count, const float* rows, float* out) {
  sum_lists(
      in, count, [rows](size_t from, const int16_t* entries) { return rows_of(rows + 4 * from, entries); },
      [out](size_t i, __m256 sum) {
        const __m128 four = sum_halves(sum), two = _mm_add_ps(four, _mm_movehl_ps(four, four));
        _mm_store_ss(out + i, _mm_add_ss(two, _mm_shuffle_ps(two, two, 1)));
      });
}

template <bool Weights>
void sum_differences_with(const ListView& in, size_t count, const PairFactors& by, const float* rows,
                          size_t own, float* out) {
  constexpr size_t kAhead = 16;
  const int16_t* const groups = in.groups;
  const uint32_t *const base = in.base, *const first = in.first;
  const float *const slopes = by.slopes, *const weights = by.weights;
  const __m256 slope = _mm256_set1_ps(by.slope), weight = _mm256_set1_ps(by.weight);
  const __m512i fours = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3),
                others = _mm512_add_epi32(fours, _mm512_set1_epi32(4));
  size_t k = first[0] / 8;
  for (size_t i = 0; i < count; ++i) {
    const size_t end = first[i + 1] / 8;
    const Floats self = {_mm512_broadcast_f32x4(_mm_load_ps(rows + 4 * (own + i)))};
    // Of the first and of the last four entries of each group.
    Floats low = Floats::zero(), high = Floats::zero();
    for (; k != end; ++k) {
      const int16_t* const group = groups + 32 * k;
      __builtin_prefetch(group + 32 * kAhead), __builtin_prefetch(slopes + 8 * (k + kAhead));
      const float* const from = rows + 4 * static_cast<size_t>(base[k]);
      __m256 factor = _mm256_mul_ps(slope, _mm256_loadu_ps(slopes + 8 * k));
      if constexpr (Weights) {
        factor = _mm256_add_ps(factor, _mm256_mul_ps(weight, _mm256_loadu_ps(weights + 8 * k)));
      }
      const __m512 each = _mm512_castps256_ps512(factor);
      low = madd({_mm512_permutexvar_ps(fours, each)}, rows_of(from, group) - self, low);
      high = madd({_mm512_permutexvar_ps(others, each)}, rows_of(from, group + 16) - self, high);
    }
    // The order in which the plain loops add up their eight lanes.
    const Floats both = low + high;
    _mm_storeu_ps(out + 4 * i, sum_halves(_mm256_add_ps(both.half<0>(), both.half<1>())));
  }
}
void sum_differences(const ListView& in, size_t count, const PairFactors& by, const float* rows, size_t own,
                     float* out) {
  by.weights ? sum_differences_with<true>(in, count, by, rows, own, out)
             : sum_differences_with<false>(in, count, by, rows, own, out);
}

constexpr SumLoops kSumLoops{sum_times, sum_dot, sum_differences};

}  // namespace

const SumLoops& avx512_sum_loops();
const SumLoops& avx512_sum_loops() {
  return kSumLoops;
}

const CellLoops& avx512_cell_loops(Smoothing kernel, int dimension);
const CellLoops& avx512_cell_loops(Smoothing kernel, int dimension) {
  const int space = dimension == 3 ? 1 : 0;
  switch (kernel) {
    case Smoothing::cubic:
      return kLoops<Smoothing::cubic>[space];
    case Smoothing::wendland_c2:
      return kLoops<Smoothing::wendland_c2>[space];
    case Smoothing::wendland_c4:
      return kLoops<Smoothing::wendland_c4>[space];
    case Smoothing::poly6_spiky:
      break;
  }
  return kLoops<Smoothing::poly6_spiky>[space];
}

}  // namespace truestep::sph
