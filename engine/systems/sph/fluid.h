// Particles in the order of their cells, and their neighbour lists: scratch that a substep makes from the
// state's rows and that does not outlive it. For each neighbour within the kernel's radius a list holds its
// slot, the gradient of the kernel there, and whatever else the method needs (pair_list.h).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/neighbours/cell_lattice.h"
#include "engine/neighbours/cell_order.h"
#include "engine/systems/sph/lists/pair_list.h"
#include "engine/systems/sph/setting.h"

namespace truestep::sph {

template <int D, class T>
struct Fluid {
  using W = Wide<T>;
  static constexpr size_t kLanes = W::kLanes;

  size_t n = 0;
  T unit = 1;                ///< 1/m, of the gradients in lists
  CellLattice<D> cells;      ///< at least as wide as the kernel's radius
  CellOrder order;           ///< of the rows
  Aligned<T> x[3];           ///< m, kLanes more than rows
  Aligned<T> place;          ///< m, four a row: positions again, for lists that are renewed
  Aligned<T> v, a;           ///< m/s and m/s^2, four numbers a row
  Aligned<T> delta;          ///< 1, density over the rest density
  Aligned<T> push, flow;     ///< m^2/s^2 and m^2/s, solutions of the two solves
  Aligned<T> iterate, next;  ///< of a solve
  Aligned<T> start, change;  ///< of a solve: initial pressures, and their change since
  Aligned<T> omega;          ///< 1/s, four a row: vorticity and its size
  Aligned<T> normal;         ///< 1, four a row: into the liquid at its surface; what is missing (tension.h)
  Aligned<T> stiffness, source;  ///< of a solve: its diagonal (1/m^2) and right-hand side
  Aligned<T> pull;               ///< four a row: sum of gradients over neighbours and walls (1/m)
  Aligned<T> wall;               ///< four a row: gradient of the walls' share (1/m); the share
  Aligned<T> drive;              ///< 1/s, rate of density due to moving walls
  Aligned<T> light;              ///< 1, density of the system over the particle's; 0: nothing moves it
  Aligned<T> rest, way, image, scale, hold;  ///< of the solve for viscosity, four a row (viscosity.h)
  bool weighted = false;                     ///< whether light is in use; otherwise it is 1 everywhere
  bool renews = false;                       ///< whether lists are renewed within a substep
  std::vector<uint8_t> held;                 ///< by which nozzle, from 1; 0: by none
  Aligned<T> shift, inside;                  ///< m, four a row; 1: of particles that are shifted (shifting.h)
  Aligned<T> rests;  ///< 1, how nearly a particle's pressure is that of a fluid at rest
  std::vector<Chunk<T>> chunks;
  std::vector<double> partial;                                           ///< by chunk or block
  const SumLoops* wide_sums = kRounded<T> ? wide_sum_loops() : nullptr;  ///< of this processor, if any

  /// Whether nothing moves a particle. It then has no pressure either: others would have to yield in its
  /// place.
  bool fixed(size_t i) const { return weighted && light[i] == 0; }
  T lightness(size_t i) const { return weighted ? light[i] : T{1}; }

  /// Row of a slot's particle.
  size_t row(size_t slot) const { return order.point(slot); }
  /// m along axis a: the offset between two particles, in a periodic box that of their nearest images.
  [[gnu::always_inline]] W nearest_image(size_t a, W way) const {
    if (!cells.wraps[a]) return way;
    const W width = W::all(static_cast<T>(cells.width[a])), half = W::all(T(0.5)) * width;
    way = select(way > half, way - width, way);
    return select(way < -half, way + width, way);
  }

  size_t chunks_in_use() const { return (n + kChunk - 1) / kChunk; }
  /// Room for this many rows and neighbours: a growing fluid would otherwise allocate it as it runs.
  void reserve(size_t rows, double neighbours, size_t extras) {
    if (!chunks.empty()) return;
    resize(rows);
    order.reserve(rows, 0);
    for (Chunk<T>& c : chunks) {
      const auto entries = static_cast<size_t>(kChunk * neighbours);
      c.need(entries, extras);
    }
  }
  void resize(size_t rows) {
    n = rows;
    for (auto& c : x) c.resize(n + kLanes);
    for (auto* c : {&v, &a, &pull, &wall}) c->resize(4 * n);
    for (auto* c :
         {&delta, &push, &flow, &iterate, &next, &start, &change, &stiffness, &source, &drive, &rests})
      c->resize(n);
    if (weighted) light.resize(n), held.resize(n);
    if (renews) place.resize(4 * n);
    if (chunks.size() < chunks_in_use()) chunks.resize(chunks_in_use());
  }

  /// body(slot, chunk, begin, end) for every particle and its list, in any order.
  template <class Body>
  void each(const ThreadArena& arena, const Body& body) const {
    arena.for_blocks(chunks_in_use(), 4, [&](size_t first, size_t last) {
      for (size_t k = first; k < last; ++k) {
        const Chunk<T>& c = chunks[k];
        const size_t low = k * kChunk, high = std::min(n, low + kChunk);
        for (size_t i = low; i < high; ++i) body(i, c, c.first[i - low], c.first[i - low + 1]);
      }
    });
  }
  /// body(slot, sums) for every particle, in any order; sums: of gradient times numbers[slot] over its list.
  template <class Body>
  void each_sum(const Aligned<T>& numbers, const ThreadArena& arena, const Body& body) const {
    arena.for_blocks(chunks_in_use(), 4, [&](size_t first, size_t last) {
      T sums[4 * kChunk];
      for (size_t k = first; k < last; ++k) {
        const size_t low = k * kChunk, count = std::min(n - low, kChunk);
        chunks[k].sum_times(numbers, count, wide_sums, sums);
        for (size_t i = 0; i < count; ++i) body(low + i, sums + 4 * i);
      }
    });
  }
  /// Sum and maximum of the first numbers that body(slot) returns, none of them negative,
  /// and sums of the second and the third.
  struct Tally {
    double sum = 0, most = 0, second = 0, third = 0;
    void add(const std::array<double, 3>& of) {
      sum += of[0], second += of[1], third += of[2];
      if (!(of[0] <= most)) most = of[0];
    }
  };
  template <class Body>
  Tally tally(const ThreadArena& arena, const Body& body) {
    return tally_chunks(arena, [&](size_t low, size_t high, Tally& part) {
      for (size_t i = low; i < high; ++i) part.add(body(i));
    });
  }
  /// The same of body(slot, sum), the sum of the products of gradients and rows[slot] over its list.
  template <class Body>
  Tally tally_dots(const Aligned<T>& rows, const ThreadArena& arena, const Body& body) {
    return tally_chunks(arena, [&](size_t low, size_t high, Tally& part) {
      T dots[kChunk];
      chunks[low / kChunk].sum_dot(rows, high - low, wide_sums, dots);
      for (size_t i = low; i < high; ++i) part.add(body(i, dots[i - low]));
    });
  }

 private:
  template <class Body>
  Tally tally_chunks(const ThreadArena& arena, const Body& body) {
    partial.resize(4 * chunks_in_use());
    arena.for_blocks(chunks_in_use(), 4, [&](size_t first, size_t last) {
      for (size_t k = first; k < last; ++k) {
        Tally part;
        body(k * kChunk, std::min(n, (k + 1) * kChunk), part);
        partial[4 * k] = part.sum, partial[4 * k + 1] = part.most;
        partial[4 * k + 2] = part.second, partial[4 * k + 3] = part.third;
      }
    });
    Tally out;
    for (size_t k = 0; k < chunks_in_use(); ++k) {
      out.sum += partial[4 * k], out.second += partial[4 * k + 2], out.third += partial[4 * k + 3];
      if (!(partial[4 * k + 1] <= out.most)) out.most = partial[4 * k + 1];
    }
    return out;
  }
};

}  // namespace truestep::sph
