// What sorting and listing neighbours does (neighbours.h); compiled once for each precision.
#pragma once
#include "engine/systems/sph/neighbours.h"

namespace truestep::sph {

template <int D, class T>
void Neighbours<D, T>::sort(Fluid<D, T>& f, const T* place, const ThreadArena& arena) const {
  const SphDef& d = set_.def;
  const double low[3] = {d.low.x, d.low.y, d.low.z}, high[3] = {d.high.x, d.high.y, d.high.z};
  // A little wider than the radius, to allow for rounding of positions.
  f.cells.divide(low, high, set_.support * 1.0001);
  for (int a = 0; a < D; ++a) f.cells.wraps[a] = d.wraps(a);
  f.order.sort(
      f.n, f.cells.cells(),
      [&](size_t i) {
        int c[3] = {};
        for (int a = 0; a < D; ++a) c[a] = f.cells.along(double{place[3 * i + static_cast<size_t>(a)]}, a);
        return f.cells.of(c);
      },
      arena);
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      for (size_t a = 0; a < D; ++a) f.x[a][k] = place[3 * f.row(k) + a];
    }
  });
  for (size_t a = 0; a < D; ++a) {
    for (size_t k = f.n; k < f.n + kLanes; ++k) f.x[a][k] = 0;
  }
}

template <int D, class T>
void Neighbours<D, T>::renew(Fluid<D, T>& f, const ThreadArena& arena) const {
  const Scales scales(*this, f);
  arena.for_blocks(f.n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (size_t a = 0; a < D; ++a) f.place[4 * i + a] = f.x[a][i];
    }
  });
  with_kernel([&](auto kernel) {
    arena.for_blocks(f.chunks_in_use(), 4, [&](size_t first, size_t last) {
      for (size_t k = first; k < last; ++k) {
        Chunk<T>& chunk = f.chunks[k];
        const size_t low = k * kChunk, high = std::min(f.n, low + kChunk);
        const typename Chunk<T>::Rows rows = chunk.rows();
        for (size_t i = low; i < high; ++i) {
          const size_t begin = chunk.first[i - low], end = chunk.first[i - low + 1];
          Sums sums;
          measure(f, i, chunk, begin, end, [&](size_t at, const W* way, const W& square) {
            evaluate<decltype(kernel)::value>(
                f, chunk, rows, at, way, square, scales, sums,
                [&](const W g[3]) { store_rows3(rows.groups[at / kLanes].g, g); });
          });
          finish<decltype(kernel)::value>(f, i, sums);
        }
      }
    });
  });
}

template <int D, class T>
void Neighbours<D, T>::list(Fluid<D, T>& f, const ThreadArena& arena) const {
  with_kernel([&](auto kernel) { list_with<decltype(kernel)::value>(f, arena); });
}

}  // namespace truestep::sph
