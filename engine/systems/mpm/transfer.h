// One particle and the nodes around it: rows of four nodes along the last axis, four numbers a node (mass or
// nothing, then momentum or velocity), so that a row is whole vectors. Pure kernels of the transfers of
// affine particles (Jiang, Schroeder, Selle, Teran, Stomakhin 2015; Hu et al. 2018, MLS-MPM).
#pragma once
#include "engine/kernels/mpm/spline.h"
#include "engine/math/wide.h"

namespace truestep::mpm {

/// Four nodes in a row with four numbers each.
template <class T>
struct NodeRow {
  static constexpr int kParts = 16 / Wide<T>::kLanes;
  static constexpr int kNodesPerPart = 4 / kParts;
  Wide<T> part[kParts];
};

/// The same four numbers for every node of a part.
template <class T>
Wide<T> every_node(const T* four) {
  Wide<T> out;
  for (int i = 0; i < Wide<T>::kLanes; ++i) out.v[i] = four[i & 3];
  return out;
}
/// A number for each node of a part.
template <class T>
Wide<T> node_numbers(const T* one_per_node) {
  Wide<T> out;
  for (int i = 0; i < Wide<T>::kLanes; ++i) out.v[i] = one_per_node[i >> 2];
  return out;
}
template <class T>
Wide<T> load(const T* p) {
  Wide<T> out;
  __builtin_memcpy(&out.v, p, sizeof out.v);
  return out;
}
template <class T>
void store(T* p, Wide<T> a) {
  __builtin_memcpy(p, &a.v, sizeof a.v);
}
/// Numbers of the nodes of a part added up.
template <class T>
void fold(Wide<T> a, T* four) {
  for (int c = 0; c < 4; ++c) four[c] = sizeof(T) == 4 ? a.v[c] + a.v[(c + 4) % Wide<T>::kLanes] : a.v[c];
}

/// Where a particle is in a tile: weights along each axis and offsets of its nodes from it (m).
template <int D, int Nodes, class T>
struct Stencil {
  T w[D][4], d[D][4];
  size_t first;  ///< index of the first node in the tile

  /// `place` is in cells from the tile's first node.
  template <size_t Width, size_t Row>
  void set(const T* place, T dx) {
    first = 0;
    for (int a = 0; a < D; ++a) {
      const int base = static_cast<int>(place[a] - Spline<Nodes, T>::kShift);
      const T f = place[a] - static_cast<T>(base);
      w[a][3] = 0;
      Spline<Nodes, T>::weights(f, w[a]);
      for (int k = 0; k < 4; ++k) d[a][k] = (static_cast<T>(k) - f) * dx;
      first = first * (a == D - 1 ? Row : Width) + static_cast<size_t>(base);
    }
  }
};

/// Adds w (m, p + A d) to the nodes of a tile; `p` is (m, momentum), `a[k]` is (0, column k of A).
template <int D, int Nodes, size_t Width, size_t Row, class T>
void scatter(const Stencil<D, Nodes, T>& s, const T* p, const T (*a)[4], T* tile) {
  using W = Wide<T>;
  constexpr int kParts = NodeRow<T>::kParts, kStep = NodeRow<T>::kNodesPerPart;
  const W center = every_node(p), last = every_node(a[D - 1]);
  W weight[kParts], slope[kParts];
  for (int q = 0; q < kParts; ++q) {
    weight[q] = node_numbers(s.w[D - 1] + kStep * q);
    slope[q] = weight[q] * node_numbers(s.d[D - 1] + kStep * q) * last;
  }
  const auto row = [&](T* at, W value, T w) {
    const W ww(w);
    for (int q = 0; q < kParts; ++q) {
      T* node = at + static_cast<size_t>(q) * Wide<T>::kLanes;
      store(node, madd(ww, madd(weight[q], value, slope[q]), load(node)));
    }
  };
  T* at = tile + 4 * s.first;
  const W x = every_node(a[0]);
  if constexpr (D == 2) {
    for (int i = 0; i < Nodes; ++i, at += 4 * Row) row(at, madd(W(s.d[0][i]), x, center), s.w[0][i]);
  } else {
    const W y = every_node(a[1]);
    for (int i = 0; i < Nodes; ++i, at += 4 * Width * Row) {
      const W value = madd(W(s.d[0][i]), x, center);
      T* line = at;
      for (int j = 0; j < Nodes; ++j, line += 4 * Row) {
        row(line, madd(W(s.d[1][j]), y, value), s.w[0][i] * s.w[1][j]);
      }
    }
  }
}

/// v = sum w u and b[k] = sum w d_k u over the nodes of a tile.
template <int D, int Nodes, size_t Width, size_t Row, class T>
void gather(const Stencil<D, Nodes, T>& s, const T* tile, T* v, T (*b)[4]) {
  using W = Wide<T>;
  constexpr int kParts = NodeRow<T>::kParts, kStep = NodeRow<T>::kNodesPerPart;
  W weight[kParts], slope[kParts];
  for (int q = 0; q < kParts; ++q) {
    weight[q] = node_numbers(s.w[D - 1] + kStep * q);
    slope[q] = weight[q] * node_numbers(s.d[D - 1] + kStep * q);
  }
  W sum = W::zero(), moment[D];
  for (int k = 0; k < D; ++k) moment[k] = W::zero();
  const auto row = [&](const T* at, T w, W& into) {
    W u = W::zero(), m = W::zero();
    for (int q = 0; q < kParts; ++q) {
      const W n = load(at + static_cast<size_t>(q) * Wide<T>::kLanes);
      u = madd(n, weight[q], u), m = madd(n, slope[q], m);
    }
    const W ww(w);
    moment[D - 1] = madd(ww, m, moment[D - 1]);
    into = ww * u;
  };
  const T* at = tile + 4 * s.first;
  W value;
  if constexpr (D == 2) {
    for (int i = 0; i < Nodes; ++i, at += 4 * Row) {
      row(at, s.w[0][i], value);
      sum += value;
      moment[0] = madd(W(s.d[0][i]), value, moment[0]);
    }
  } else {
    for (int i = 0; i < Nodes; ++i, at += 4 * Width * Row) {
      const T* line = at;
      W plane = W::zero();
      for (int j = 0; j < Nodes; ++j, line += 4 * Row) {
        row(line, s.w[0][i] * s.w[1][j], value);
        plane += value;
        moment[1] = madd(W(s.d[1][j]), value, moment[1]);
      }
      sum += plane;
      moment[0] = madd(W(s.d[0][i]), plane, moment[0]);
    }
  }
  fold(sum, v);
  for (int k = 0; k < D; ++k) fold(moment[k], b[k]);
}

}  // namespace truestep::mpm
