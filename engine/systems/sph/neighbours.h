// Sorting particles into cells and listing their neighbours with kernel values and gradients.
#pragma once
#include <type_traits>

#include "engine/systems/sph/lists/around.h"

namespace truestep::sph {

template <int D, class T>
class Neighbours {
 public:
  using W = Wide<T>;
  static constexpr size_t kLanes = W::kLanes;
  explicit Neighbours(const Setting& set) : set_(set) {
    const SphDef& d = set.def;
    if (d.viscosity > 0 || d.xsph > 0 || d.solver != Method::dfsph) extras_ = Extras::slopes;
    if (d.surface_tension > 0) extras_ = Extras::slopes;
    if (d.xsph > 0 || set.shifting > 0 || (d.solver == Method::pbf && d.artificial_pressure > 0))
      extras_ = Extras::weights;
    if (d.surface_tension > 0 && kRounded<T>) extras_ = Extras::distances;
    if constexpr (kRounded<T>) {
      unit_ = set.kernel_s * set.support * steepest(set.def.kernel) / kGradientSteps;
      wide_ = wide_cell_loops(set.def.kernel, D);
    }
  }

  /// 1/m, of the gradients in lists.
  T unit() const { return static_cast<T>(unit_); }
  Extras extras() const { return extras_; }
  /// Whether the wide-register loops make the lists.
  bool wide() const { return wide_ != nullptr; }
  void leave_out_wide() { wide_ = nullptr; }

  /// Order by cell for positions given as n x 3, ties by row: fills the order, cells and x of f.
  void sort(Fluid<D, T>& f, const T* place, const ThreadArena& arena) const;

  /// Recomputes the entries of the same lists for the current positions.
  void renew(Fluid<D, T>& f, const ThreadArena& arena) const;

  /// Makes the lists of all particles; from them and the walls' shares, which must already be set (walls.h),
  /// density, stiffness and pull.
  void list(Fluid<D, T>& f, const ThreadArena& arena) const;

 private:
  static constexpr size_t kAhead = 16;  ///< groups
  struct Scales {
    Scales(const Neighbours& of, const Fluid<D, T>& f)
        : far(W::all(static_cast<T>(of.set_.support * of.set_.support))),
          inverse(W::all(static_cast<T>(1 / of.set_.support))),
          one(W::all(1)),
          kw(W::all(static_cast<T>(of.set_.kernel_w))),
          ks(W::all(static_cast<T>(of.set_.kernel_s))),
          per_unit(W::all(static_cast<T>(1 / of.unit_))),
          extras(of.extras_),
          weighted(f.weighted) {}
    W far, inverse, one, kw, ks, per_unit;
    Extras extras;
    bool weighted;
  };
  /// Sums over a list: values, squares of gradients and gradients.
  struct Sums {
    W density = W::zero(), squares = W::zero(), pull[3] = {W::zero(), W::zero(), W::zero()};
  };

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
    const Scales scales(*this, f);
    arena.for_blocks(f.chunks_in_use(), 4, [&](size_t first, size_t last) {
      for (size_t k = first; k < last; ++k) {
        Chunk<T>& chunk = f.chunks[k];
        const size_t low = k * kChunk, high = std::min(f.n, low + kChunk);
        size_t used = 0;
        chunk.first[0] = 0;
        for (size_t i = low; i < high;) {
          const Around<D, T> cell = look_around(f, i, high, chunk);
          if (chunk.around_in_order && wide_) {
            used = wide_lists_of<K>(f, i, cell, low, chunk, used);
          } else {
            keep_near(f, i, cell, static_cast<T>(set_.support * set_.support), chunk);
            used = chunk.around_in_order ? lists_of<K, true>(f, i, cell.stop, low, chunk, used, scales)
                                         : lists_of<K, false>(f, i, cell.stop, low, chunk, used, scales);
          }
          i = cell.stop;
        }
      }
    });
  }
  /// Makes the lists of the particles from i to `stop`, all of one cell.
  template <Smoothing K, bool InOrder>
  size_t lists_of(Fluid<D, T>& f, size_t i, size_t stop, size_t low, Chunk<T>& chunk, size_t used,
                  const Scales& scales) const {
    for (; i < stop; ++i) {
      // Room for every candidate to be a neighbour, so that it seldom grows after the first step.
      chunk.need(used + chunk.around_seen + kLanes, static_cast<size_t>(scales.extras));
      used = list_of<K, InOrder>(f, i, chunk, used, find(f, i, chunk), scales);
      chunk.first[i - low + 1] = static_cast<uint32_t>(used);
    }
    return used;
  }
  /// The same by the wide-register loops.
  template <Smoothing K>
  size_t wide_lists_of(Fluid<D, T>& f, size_t i, const Around<D, T>& cell, size_t low, Chunk<T>& chunk,
                       size_t used) const {
    if constexpr (kRounded<T>) {
      const ListInput in = wide_input(f, cell, chunk, set_, unit_);
      chunk.around_count = wide_->around(in);
      while (i < cell.stop) {
        chunk.need(used + chunk.around_seen + 2 * kLanes, static_cast<size_t>(extras_));
        ListOutput out;
        wide_output(chunk, used, extras_, out);
        const size_t made = wide_->lists(in, chunk.around_count, i, cell.stop, out);
        for (size_t k = 0; k < made; ++k, ++i) {
          const ListSums& s = out.sums[k];
          finish<K>(f, i,
                    {load(s.density), load(s.squares), {load(s.pull[0]), load(s.pull[1]), load(s.pull[2])}});
          chunk.first[i - low + 1] = out.ends[k];
        }
        used = out.used;
      }
    }
    return used;
  }

  /// Writes the neighbours of particle i into chunk.near; returns their number.
  [[gnu::always_inline]] size_t find(const Fluid<D, T>& f, size_t i, Chunk<T>& chunk) const {
    const W limit = W::all(static_cast<T>(set_.support * set_.support));
    W here[D];
    const T* around[D];
    for (size_t a = 0; a < D; ++a) here[a] = W::all(f.x[a][i]), around[a] = chunk.around[a].data();
    uint32_t* const near = chunk.near.data();
    const size_t own = chunk.own + i, count = chunk.around_count;
    size_t found = 0;
    // Each group is stored, with or without neighbours, and the particle itself is left out of every group:
    // both cost less than a mispredicted branch.
    for (size_t k = 0; k < count; k += kLanes) {
      W square = W::zero();
      for (size_t a = 0; a < D; ++a) {
        const W way = here[a] - load(around[a] + k);
        square = madd(way, way, square);
      }
      const size_t lane = own - k;
      const uint32_t itself = static_cast<uint32_t>(lane < kLanes) << (lane % kLanes);
      found +=
          store_lanes<kLanes>(near + found, static_cast<uint32_t>(k), bits_below(square, limit) & ~itself);
    }
    for (size_t lane = 0; lane < kLanes; ++lane) near[found + lane] = 0;
    return found;
  }

  /// Appends the list of the `count` neighbours of particle i in chunk.near after the first `used` entries;
  /// returns its end, a multiple of the group size.
  template <Smoothing K, bool InOrder>
  [[gnu::always_inline]] size_t list_of(Fluid<D, T>& f, size_t i, Chunk<T>& chunk, size_t used, size_t count,
                                        const Scales& scales) const {
    W here[D];
    for (size_t a = 0; a < D; ++a) here[a] = W::all(f.x[a][i]);
    Sums sums;
    typename Chunk<T>::Rows rows = chunk.rows();
    for (size_t at = 0; at < count; used += kLanes) {
      if constexpr (!InOrder) {
        chunk.need(used + kLanes, static_cast<size_t>(scales.extras));
        rows = chunk.rows();
      }
      W there[4], way[3], square = W::zero();
      const auto taken = chunk.template take<InOrder>(at, count, there);
      rows.base[used / kLanes] = taken.base;
      // Lists are written to memory that is seldom cached.
      __builtin_prefetch(rows.groups + used / kLanes + kAhead, 1);
      for (size_t a = 0; a < D; ++a) {
        way[a] = here[a] - there[a];
        square = madd(way[a], way[a], square);
        // Rounded gradients are 0 at the kernel's radius in any case.
        if constexpr (!kRounded<T>) way[a] = select(taken.inside, way[a], W::zero());
      }
      square = select(taken.inside, square, scales.far);
      evaluate<K>(f, chunk, rows, used, way, square, scales, sums,
                  [&](const W g[3]) { rows.groups[used / kLanes].set(g, taken.above); });
      at += taken.count;
    }
    finish<K>(f, i, sums);
    return used;
  }

  /// Calls body(entry, offsets, squared distance) for the groups of a list.
  template <class Body>
  void measure(const Fluid<D, T>& f, size_t i, const Chunk<T>& chunk, size_t begin, size_t end,
               const Body& body) const {
    const W far = W::all(static_cast<T>(set_.support * set_.support));
    W here[D];
    for (size_t a = 0; a < D; ++a) here[a] = W::all(f.x[a][i]);
    for (size_t k = begin; k < end; k += kLanes) {
      W there[4], way[3], square = W::zero();
      chunk.rows_of(f.place, k, there);
      for (size_t a = 0; a < D; ++a) {
        way[a] = f.nearest_image(a, here[a] - there[a]);
        square += way[a] * way[a];
      }
      square = select(chunk.group(k).padding(), far, min(square, far));
      body(k, way, square);
    }
  }

  /// Gradients, and whatever else is kept, of the group at entry k, from offsets and squared distances;
  /// store(gradients) puts them into the group.
  template <Smoothing K, class Store>
  [[gnu::always_inline]] void evaluate(const Fluid<D, T>& f, const Chunk<T>& chunk,
                                       const typename Chunk<T>::Rows& rows, size_t k, const W* way,
                                       const W& distance2, const Scales& scales, Sums& sums,
                                       const Store& store_group) const {
    const W q = min(sqrt(distance2) * scales.inverse, scales.one);
    const SmoothingValue<T> value = smoothing<K, T>(q);
    const W w = scales.kw * value.w, s = scales.ks * value.s;
    sums.density += w;
    W square = W::zero(), g[3] = {W::zero(), W::zero(), W::zero()};
    for (size_t a = 0; a < D; ++a) {
      g[a] = s * way[a];
      if constexpr (kRounded<T>) g[a] = nearest(g[a] * scales.per_unit);
      sums.pull[a] += g[a];
      if (scales.weighted) {
        square = madd(g[a], g[a], square);
      } else {
        sums.squares = madd(g[a], g[a], sums.squares);
      }
    }
    store_group(g);
    if (scales.weighted) sums.squares = madd(square, chunk.of(f.light, k), sums.squares);
    if (scales.extras >= Extras::slopes) store(rows.s + k, s);
    if (scales.extras >= Extras::weights) store(rows.w + k, w);
    if (scales.extras == Extras::distances) store(rows.q + k, q);
  }

  /// Density, pull and stiffness of particle i from the sums over its list.
  template <Smoothing K>
  void finish(Fluid<D, T>& f, size_t i, const Sums& sums) const {
    const SmoothingValue<T> self = smoothing<K, T>(W::zero());
    const T* wall = f.wall.data() + 4 * i;
    T each[4];
    const W lanes[4] = {sums.pull[0], sums.pull[1], sums.pull[2], sums.density};
    sum_each(lanes, each);
    f.delta[i] = each[3] + static_cast<T>(set_.kernel_w) * self.w[0] + wall[3];
    T both = f.unit * f.unit * sum(sums.squares);
    T* total = f.pull.data() + 4 * i;
    total[3] = 0;
    for (int a = 0; a < 3; ++a) {
      const T inside = a < D ? f.unit * each[a] : T{0}, outside = a < D ? wall[a] : T{0};
      total[a] = inside + outside;
      both += f.lightness(i) * total[a] * total[a];
    }
    f.stiffness[i] = both;
  }

  const Setting& set_;
  double unit_ = 1;
  Extras extras_ = Extras::none;
  const CellLoops* wide_ = nullptr;  ///< of this processor, if it has any
};

}  // namespace truestep::sph
