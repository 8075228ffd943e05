// Transfers between a group of particles, one to a lane, and the nodes around each: four numbers a node (mass
// or nothing, then momentum or velocity), so that two nodes of floats or one of doubles fill a vector. Pure
// kernels for affine particles (Jiang, Schroeder, Selle, Teran, Stomakhin 2015; Hu et al. 2018, MLS-MPM).
// Weights are products over the axes, so sums are taken axis by axis: 62 vector multiplications instead of a
// hundred for a particle in space.
#pragma once
#include <cstring>

#include "engine/kernels/mpm/spline.h"
#include "engine/math/wide_rows.h"

namespace truestep::mpm {

template <class T>
Wide<T> load(const T* p) {
  Wide<T> out;
  std::memcpy(&out.v, p, sizeof out.v);
  return out;
}
template <class T>
void store(T* p, Wide<T> a) {
  std::memcpy(p, &a.v, sizeof a.v);
}

namespace transfer_detail {

/// Vectors that the four nodes of a row fill, and how many of them a spline reaches.
template <int Nodes, class T>
inline constexpr int kParts = (4 * Nodes + Wide<T>::kLanes - 1) / Wide<T>::kLanes;

/// Repeats four numbers for every node of a vector.
template <class T>
Wide<T> every_node(const T* four) {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    return {(typename Wide<T>::Raw)_mm256_broadcast_ps(reinterpret_cast<const __m128*>(four))};
  }
#endif
  Wide<T> out;
  for (int i = 0; i < Wide<T>::kLanes; ++i) out.v[i] = four[i & 3];
  return out;
}
/// One number for each node of a vector, `stride` apart.
template <class T>
Wide<T> node_numbers(const T* p, size_t stride) {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    return {(typename Wide<T>::Raw)_mm256_blend_ps(_mm256_broadcast_ss(p), _mm256_broadcast_ss(p + stride),
                                                   0xf0)};
  }
#endif
  Wide<T> out;
  for (int i = 0; i < Wide<T>::kLanes; ++i) out.v[i] = p[static_cast<size_t>(i >> 2) * stride];
  return out;
}
/// Sums the numbers of the nodes of a vector.
template <class T>
void fold(Wide<T> a, T* four) {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (sizeof(T) == 4) {
    const auto v = (__m256)a.v;
    _mm_storeu_ps(four, _mm_add_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1)));
    return;
  }
#endif
  for (int c = 0; c < 4; ++c) four[c] = sizeof(T) == 4 ? a.v[c] + a.v[(c + 4) % Wide<T>::kLanes] : a.v[c];
}

inline constexpr uint32_t kLaneRows[8] = {0, 1, 2, 3, 4, 5, 6, 7};

}  // namespace transfer_detail

/// Four numbers of every lane, to a row for each lane and back.
template <class T>
void to_rows(const Wide<T> in[4], T* rows) {
  scatter_rows4(rows, transfer_detail::kLaneRows, in);
}
template <class T>
void from_rows(const T* rows, Wide<T> out[4]) {
  gather_rows4(rows, transfer_detail::kLaneRows, out);
}

/// Positions of a group's particles in a tile.
template <int D, int Nodes, class T>
struct Stencils {
  using W = Wide<T>;
  static constexpr int kLanes = W::kLanes;
  alignas(32) T w[D][4][kLanes];      ///< weights along each axis
  alignas(32) T wd[D][4][kLanes];     ///< times the offset of the node from the particle, m
  alignas(32) int32_t first[kLanes];  ///< index of the first node in the tile

  /// `place` is in cells from the tile's first node.
  template <int Width, int Row>
  void set(const W* place, T dx) {
    typedef int32_t Index __attribute__((vector_size(4 * kLanes)));
    Index at = {};
    // A position that is not finite, or beyond the tile, is clamped to it; the check after the step reports
    // it.
    const W shift(Spline<Nodes, T>::kShift), most(Width - Nodes + 0.99);
    for (int a = 0; a < D; ++a) {
      const W from = min(max(place[a] - shift, W::zero()), most);
      const Index base = __builtin_convertvector(from.v, Index);
      const W f = from + shift - W(__builtin_convertvector(base, typename W::Raw));
      W weight[4];
      spline_weights<Nodes>(f, weight);
      for (int k = 0; k < 4; ++k) {
        const W here = k < Nodes ? weight[k] : W::zero();
        store(w[a][k], here), store(wd[a][k], here * ((W(T(k)) - f) * W(dx)));
      }
      at = at * (a == D - 1 ? Row : Width) + base;
    }
    std::memcpy(first, &at, sizeof at);
  }
};

/// Adds w (m, p + A d) of one lane to the nodes of a tile. `rows` are four numbers a lane, one group after
/// another: (m, p), then (0, column k of A) of every axis k.
template <int D, int Nodes, int Width, int Row, class T>
[[gnu::always_inline]] inline void scatter(const Stencils<D, Nodes, T>& s, int lane, const T* rows, T* tile) {
  using W = Wide<T>;
  using namespace transfer_detail;
  constexpr int kMany = kParts<Nodes, T>, kNodes = W::kLanes / 4, kGroup = 4 * W::kLanes;
  const auto number = [&](int k) { return every_node(rows + kGroup * k + 4 * lane); };
  const W center = number(0), last = number(D), x = number(1);
  W g[kMany], gx[kMany], gy[kMany];
  for (int q = 0; q < kMany; ++q) {
    const W weight = node_numbers(&s.w[D - 1][kNodes * q][lane], W::kLanes);
    const W slope = node_numbers(&s.wd[D - 1][kNodes * q][lane], W::kLanes);
    g[q] = madd(slope, last, weight * center), gx[q] = weight * x;
    if constexpr (D == 3) gy[q] = weight * number(2);
  }
  T* at = tile + 4 * static_cast<ptrdiff_t>(s.first[lane]);
  for (int i = 0; i < Nodes; ++i, at += 4 * Row * (D == 3 ? Width : 1)) {
    const W w(s.w[0][i][lane]), wd(s.wd[0][i][lane]);
    W p[kMany], r[kMany];
    for (int q = 0; q < kMany; ++q) {
      p[q] = madd(wd, gx[q], w * g[q]);
      if constexpr (D == 3) r[q] = w * gy[q];
    }
    if constexpr (D == 2) {
      for (int q = 0; q < kMany; ++q) {
        T* node = at + q * W::kLanes;
        store(node, load(node) + p[q]);
      }
    } else {
      T* line = at;
      for (int j = 0; j < Nodes; ++j, line += 4 * Row) {
        const W wy(s.w[1][j][lane]), wdy(s.wd[1][j][lane]);
        for (int q = 0; q < kMany; ++q) {
          T* node = line + q * W::kLanes;
          store(node, madd(wy, p[q], madd(wdy, r[q], load(node))));
        }
      }
    }
  }
}

/// Sums over the nodes around one lane, four numbers each as in `scatter`: w u, then w d_k u for every axis
/// k.
template <int D, int Nodes, int Width, int Row, class T>
[[gnu::always_inline]] inline void gather(const Stencils<D, Nodes, T>& s, int lane, const T* tile, T* rows) {
  using W = Wide<T>;
  using namespace transfer_detail;
  constexpr int kMany = kParts<Nodes, T>, kNodes = W::kLanes / 4, kGroup = 4 * W::kLanes;
  W a[kMany], b[kMany], c[kMany];
  for (int q = 0; q < kMany; ++q) a[q] = b[q] = c[q] = W::zero();
  const T* at = tile + 4 * static_cast<ptrdiff_t>(s.first[lane]);
  for (int i = 0; i < Nodes; ++i, at += 4 * Row * (D == 3 ? Width : 1)) {
    const W w(s.w[0][i][lane]), wd(s.wd[0][i][lane]);
    if constexpr (D == 2) {
      for (int q = 0; q < kMany; ++q) {
        const W n = load(at + q * W::kLanes);
        a[q] = madd(w, n, a[q]), b[q] = madd(wd, n, b[q]);
      }
    } else {
      W p[kMany], r[kMany];
      for (int q = 0; q < kMany; ++q) p[q] = r[q] = W::zero();
      const T* line = at;
      for (int j = 0; j < Nodes; ++j, line += 4 * Row) {
        const W wy(s.w[1][j][lane]), wdy(s.wd[1][j][lane]);
        for (int q = 0; q < kMany; ++q) {
          const W n = load(line + q * W::kLanes);
          p[q] = madd(wy, n, p[q]), r[q] = madd(wdy, n, r[q]);
        }
      }
      for (int q = 0; q < kMany; ++q) {
        a[q] = madd(w, p[q], a[q]), b[q] = madd(wd, p[q], b[q]), c[q] = madd(w, r[q], c[q]);
      }
    }
  }
  W sum = W::zero(), mx = W::zero(), my = W::zero(), last = W::zero();
  for (int q = 0; q < kMany; ++q) {
    const W weight = node_numbers(&s.w[D - 1][kNodes * q][lane], W::kLanes);
    const W slope = node_numbers(&s.wd[D - 1][kNodes * q][lane], W::kLanes);
    sum = madd(weight, a[q], sum), last = madd(slope, a[q], last), mx = madd(weight, b[q], mx);
    if constexpr (D == 3) my = madd(weight, c[q], my);
  }
  T* out = rows + 4 * lane;
  fold(sum, out), fold(mx, out + kGroup);
  if constexpr (D == 3) fold(my, out + 2 * kGroup);
  fold(last, out + D * kGroup);
}

}  // namespace truestep::mpm
