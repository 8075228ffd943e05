// The surroundings of a cell: the slots among which its particles' neighbours lie, in the form that the loops
// which build lists take them.
#pragma once
#include <algorithm>

#include "engine/kernels/sph/wide/cell_loops.h"
#include "engine/systems/sph/fluid.h"

namespace truestep::sph {

/// What a list stores besides gradients: slopes; slopes and weights; or those and distances.
enum class Extras : uint8_t { none, slopes, weights, distances };

/// A cell's particles, up to the slot `stop`; the box around them; the slots in the cells around.
template <int D, class T>
struct Around {
  static constexpr size_t kMost = 27;
  size_t stop = 0, run_count = 0;
  Wide<T> low[D], top[D];  ///< m
  SlotRun runs[kMost];
};

/// Around the cell of particle i, whose particles are taken up to `high`; makes room in `chunk`.
template <int D, class T>
inline Around<D, T> look_around(const Fluid<D, T>& f, size_t i, size_t high, Chunk<T>& chunk) {
  using W = Wide<T>;
  constexpr size_t kLanes = W::kLanes;
  Around<D, T> out;
  int c[3] = {};
  for (size_t a = 0; a < D; ++a) c[a] = f.cells.along(double{f.x[a][i]}, static_cast<int>(a));
  const size_t stop = std::min(high, size_t{f.order.start(f.cells.of(c) + 1)});
  out.stop = stop;
  for (size_t a = 0; a < D; ++a) {
    const T* x = f.x[a].data();
    W low = W::all(x[i]), top = low;
    for (size_t k = i; k < stop; k += kLanes) {
      const W place = select(first_lanes<T>(std::min(stop - k, kLanes)), load(x + k), low);
      low = min(low, place), top = max(top, place);
    }
    out.low[a] = smallest(low), out.top[a] = largest(top);
  }
  size_t least = f.n, before = 0, seen = 0;
  bool ascends = true;
  f.cells.around(c, [&](size_t from, size_t to, const double* shift) {
    const size_t begin = f.order.start(from), end = f.order.start(to);
    ascends = ascends && begin >= before;
    least = std::min(least, begin), before = end, seen += end - begin;
    out.runs[out.run_count++] = {begin, end, {shift[0], shift[1], shift[2]}};
  });
  chunk.need_around(seen);
  chunk.around_in_order = ascends && before <= least + kMostAbove + 1;
  return out;
}

/// Collects the slots within the kernel's radius (its square: `limit`, m^2) of the box.
template <int D, class T>
inline void keep_near(const Fluid<D, T>& f, size_t i, const Around<D, T>& cell, T limit, Chunk<T>& chunk) {
  chunk.around_count = 0;
  for (size_t r = 0; r < cell.run_count; ++r) {
    const SlotRun& run = cell.runs[r];
    const bool moved = run.shift[0] != 0 || run.shift[1] != 0 || run.shift[2] != 0;
    const size_t own = run.begin <= i && i < run.end && !moved ? i : SIZE_MAX;
    chunk.template put_around<D>(f.x, run.begin, run.end, own, run.shift, cell.low, cell.top,
                                 Wide<T>::all(limit));
  }
  chunk.template end_around<D>();
}

/// The same cell as input of the wide-register loops, with the chunk's scratch; `unit` (1/m) of gradients.
template <int D>
inline ListInput wide_input(const Fluid<D, float>& f, const Around<D, float>& cell, Chunk<float>& chunk,
                            const Setting& set, double unit) {
  ListInput in{};
  const size_t room = chunk.around_slots.size();
  for (size_t a = 0; a < D; ++a) {
    in.x[a] = f.x[a].data(), in.low[a] = cell.low[a][0], in.top[a] = cell.top[a][0];
    in.around[a] = chunk.around[a].data();
  }
  in.around_slots = chunk.around_slots.data();
  for (size_t k = 0; k < 2; ++k) {
    float* const columns = chunk.around_rows.data() + 4 * k * room;
    in.found[k] = {
        {columns, columns + room, columns + 2 * room}, columns + 3 * room, chunk.near.data() + k * room};
  }
  in.light = f.weighted ? f.light.data() : nullptr;
  in.runs = cell.runs, in.run_count = cell.run_count;
  in.square = static_cast<float>(set.support * set.support), in.inverse = static_cast<float>(1 / set.support);
  in.kernel_w = static_cast<float>(set.kernel_w), in.kernel_s = static_cast<float>(set.kernel_s);
  in.per_unit = static_cast<float>(1 / unit);
  return in;
}
inline void wide_output(Chunk<float>& chunk, size_t used, Extras extras, ListOutput& out) {
  const Chunk<float>::Rows rows = chunk.rows();
  out.groups = rows.groups[0].g[0], out.base = rows.base;
  out.slopes = extras >= Extras::slopes ? rows.s : nullptr;
  out.weights = extras >= Extras::weights ? rows.w : nullptr;
  out.distances = extras == Extras::distances ? rows.q : nullptr;
  out.used = used, out.room = Chunk<float>::kLanes * chunk.groups.size();
}

}  // namespace truestep::sph
