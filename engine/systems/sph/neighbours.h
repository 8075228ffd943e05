// Sorting particles into cells and listing their neighbours with kernel values and gradients.
#pragma once
#include <type_traits>

#include "engine/systems/sph/fluid.h"

namespace truestep::sph {

template <int D, class T>
class Neighbours {
 public:
  using W = Wide<T>;
  static constexpr size_t kLanes = W::kLanes;
  /// What lists hold besides gradients: slopes and weights; distances too.
  enum class Extras : uint8_t { none, slopes, distances };

  explicit Neighbours(const Setting& set) : set_(set) {
    const SphDef& d = set.def;
    if (d.viscosity > 0 || d.xsph > 0 || d.solver != Method::dfsph) extras_ = Extras::slopes;
    if (d.surface_tension > 0) extras_ = kRounded<T> ? Extras::distances : Extras::slopes;
    if constexpr (kRounded<T>) {
      unit_ = set.kernel_s * set.support * steepest(set.def.kernel) / kGradientSteps;
    }
  }

  /// 1/m, of the gradients in lists.
  T unit() const { return static_cast<T>(unit_); }
  Extras extras() const { return extras_; }

  /// Order by cell for positions given as n x 3, ties by row: fills row and x of f.
  void sort(Fluid<D, T>& f, const T* place, const ThreadArena& arena) const {
    Cells<D>& cells = f.cells;
    if (cells.start.empty()) cells.set(set_.def, set_.support);
    const size_t n = f.n;
    arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        int c[3] = {};
        for (int a = 0; a < D; ++a) c[a] = cells.along(double{place[3 * i + static_cast<size_t>(a)]}, a);
        f.cell_of[i] = static_cast<uint32_t>(cells.of(c));
      }
    });
    std::fill(cells.start.begin(), cells.start.end(), 0);
    for (size_t i = 0; i < n; ++i) ++cells.start[f.cell_of[i] + 1];
    for (size_t k = 1; k < cells.start.size(); ++k) cells.start[k] += cells.start[k - 1];
    f.cursor.assign(cells.start.begin(), cells.start.end() - 1);
    for (size_t i = 0; i < n; ++i) f.row[f.cursor[f.cell_of[i]]++] = static_cast<uint32_t>(i);
    arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        for (size_t a = 0; a < D; ++a) f.x[a][k] = place[3 * size_t{f.row[k]} + a];
      }
    });
    for (size_t a = 0; a < D; ++a) {
      for (size_t k = n; k < n + kLanes; ++k) f.x[a][k] = 0;
    }
  }

  /// Updates the same lists for the current positions.
  void renew(Fluid<D, T>& f, const ThreadArena& arena) const {
    with_kernel([&](auto kernel) {
      arena.for_blocks(f.chunks_in_use(), 4, [&](size_t first, size_t last) {
        for (size_t k = first; k < last; ++k) {
          Chunk<T>& chunk = f.chunks[k];
          const size_t low = k * kChunk, high = std::min(f.n, low + kChunk);
          for (size_t i = low; i < high; ++i) {
            const size_t begin = chunk.first[i - low], end = chunk.first[i - low + 1];
            measure(f, i, chunk, begin, end);
            evaluate<decltype(kernel)::value>(f, i, chunk, begin, end);
          }
        }
      });
    });
  }

  /// Lists of all particles; from them and the walls' share, which must be there (walls.h), density,
  /// stiffness and pull.
  void list(Fluid<D, T>& f, const ThreadArena& arena) const {
    with_kernel([&](auto kernel) { list_with<decltype(kernel)::value>(f, arena); });
  }

 private:
  /// body(a type whose `value` is the kernel).
  template <class Body>
  void with_kernel(const Body& body) const {
    switch (set_.def.kernel) {
      case Smoothing::cubic:
        return body(std::integral_constant<Smoothing, Smoothing::cubic>{});
      case Smoothing::wendland_c2:
        return body(std::integral_constant<Smoothing, Smoothing::wendland_c2>{});
      case Smoothing::wendland_c4:
        return body(std::integral_constant<Smoothing, Smoothing::wendland_c4>{});
      case Smoothing::poly6_spiky:
        return body(std::integral_constant<Smoothing, Smoothing::poly6_spiky>{});
    }
  }

  template <Smoothing K>
  void list_with(Fluid<D, T>& f, const ThreadArena& arena) const {
    arena.for_blocks(f.chunks_in_use(), 4, [&](size_t first, size_t last) {
      for (size_t k = first; k < last; ++k) {
        Chunk<T>& chunk = f.chunks[k];
        const size_t low = k * kChunk, high = std::min(f.n, low + kChunk);
        size_t used = 0;
        uint32_t cell = 0;
        chunk.first[0] = 0;
        for (size_t i = low; i < high; ++i) {
          const uint32_t now = f.cell_of[f.row[i]];
          if (i == low || now != cell) look_around(f, i, chunk);
          cell = now;
          const size_t end = find(f, i, chunk, used);
          evaluate<K>(f, i, chunk, used, end);
          used = end;
          chunk.first[i - low + 1] = static_cast<uint32_t>(used);
        }
      }
    });
  }

  /// Collects the particles in the cells around particle i's.
  void look_around(const Fluid<D, T>& f, size_t i, Chunk<T>& chunk) const {
    int c[3] = {};
    for (size_t a = 0; a < D; ++a) c[a] = f.cells.along(double{f.x[a][i]}, static_cast<int>(a));
    chunk.around_count = 0;
    f.cells.around(c, [&](size_t begin, size_t stop, const double* shift) {
      if (begin <= i && i < stop) chunk.own = chunk.around_count - begin;
      chunk.template put_around<D>(f.x, begin, stop, shift);
    });
    chunk.end_around();
  }

  /// Appends the neighbours of particle i, with offsets and squared distances, after `used` entries; returns
  /// the end.
  size_t find(const Fluid<D, T>& f, size_t i, Chunk<T>& chunk, size_t used) const {
    const T far = static_cast<T>(set_.support * set_.support);
    const W limit = W::all(far);
    W here[D];
    for (size_t a = 0; a < D; ++a) here[a] = W::all(f.x[a][i]);
    const size_t own = chunk.own + i;
    chunk.need(used, used, chunk.around_count + kLanes, static_cast<size_t>(extras_));
    size_t at = 0;
    // Every group is stored, with or without neighbours: that costs less than mispredicted branches.
    for (size_t k = 0; k < chunk.around_count; k += kLanes) {
      W way[D], square = W::zero();
      for (size_t a = 0; a < D; ++a) {
        way[a] = here[a] - load(chunk.around[a].data() + k);
        square = madd(way[a], way[a], square);
      }
      uint32_t bits = bits_below(square, limit);
      if (own - k < kLanes) bits &= ~(1u << (own - k));
      const LanesOf<T> lanes(bits);
      lanes.store(chunk.near.data() + at, chunk.around_slots.data() + k);
      for (size_t a = 0; a < D; ++a) lanes.store(chunk.away[a].data() + at, way[a]);
      lanes.store(chunk.square.data() + at, square);
      at += lanes.count();
    }
    return chunk.pack(used, used + at, far, static_cast<size_t>(extras_));
  }

  /// Offsets and squared distances of the neighbours in a list.
  void measure(const Fluid<D, T>& f, size_t i, Chunk<T>& chunk, size_t begin, size_t end) const {
    const T far = static_cast<T>(set_.support * set_.support);
    for (size_t k = begin; k < end; k += kLanes) {
      W square = W::zero();
      for (size_t a = 0; a < D; ++a) {
        W d = W::all(f.x[a][i]) - chunk.of(f.x[a], k);
        if (f.cells.wraps[a]) {
          const W width = W::all(static_cast<T>(f.cells.width[a])), half = W::all(T(0.5)) * width;
          d = select(d > half, d - width, d);
          d = select(d < -half, d + width, d);
        }
        store(chunk.away[a].data() + (k - begin), d);
        square += d * d;
      }
      store(chunk.square.data() + (k - begin), min(square, W::all(far)));
      // A neighbour is in a list only once: a repeat of its group's first slot is padding.
      for (size_t last = kLanes; last-- > 1 && chunk.group(k).above(last) == 0;) {
        chunk.square[k - begin + last] = far;
      }
    }
  }

  /// Gradients, and whatever else is kept, from offsets and squared distances; and the sums over the list.
  template <Smoothing K>
  void evaluate(Fluid<D, T>& f, size_t i, Chunk<T>& chunk, size_t begin, size_t end) const {
    const W inverse = W::all(static_cast<T>(1 / set_.support)), one = W::all(1);
    const W kw = W::all(static_cast<T>(set_.kernel_w)), ks = W::all(static_cast<T>(set_.kernel_s));
    W density = W::zero(), squares = W::zero(), pull[3] = {W::zero(), W::zero(), W::zero()};
    for (size_t k = begin; k < end; k += kLanes) {
      const W q = min(sqrt(load(chunk.square.data() + (k - begin))) * inverse, one);
      const SmoothingValue<T> value = smoothing<K, T>(q);
      const W w = kw * value.w, s = ks * value.s;
      density += w;
      W square = W::zero(), g[3] = {W::zero(), W::zero(), W::zero()};
      for (size_t a = 0; a < D; ++a) {
        g[a] = s * load(chunk.away[a].data() + (k - begin));
        if constexpr (kRounded<T>) g[a] = nearest(g[a] * W::all(static_cast<T>(1 / unit_)));
        pull[a] += g[a];
        if (f.weighted) {
          square = madd(g[a], g[a], square);
        } else {
          squares = madd(g[a], g[a], squares);
        }
      }
      store_rows3(chunk.group(k).g, g);
      if (f.weighted) squares = madd(square, chunk.of(f.light, k), squares);
      if (extras_ != Extras::none) store(chunk.s.data() + k, s), store(chunk.w.data() + k, w);
      if (extras_ == Extras::distances) store(chunk.q.data() + k, q);
    }
    const SmoothingValue<T> self = smoothing<K, T>(W::zero());
    const T* wall = f.wall.data() + 4 * i;
    f.delta[i] = sum(density) + static_cast<T>(set_.kernel_w) * self.w[0] + wall[3];
    T both = f.unit * f.unit * sum(squares);
    T* total = f.pull.data() + 4 * i;
    total[3] = 0;
    for (int a = 0; a < 3; ++a) {
      const T inside = a < D ? f.unit * sum(pull[a]) : T{0}, outside = a < D ? wall[a] : T{0};
      total[a] = inside + outside;
      both += f.lightness(i) * total[a] * total[a];
    }
    f.stiffness[i] = both;
  }

  const Setting& set_;
  double unit_ = 1;
  Extras extras_ = Extras::none;
};

}  // namespace truestep::sph
