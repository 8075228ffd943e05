// Particles in the order of their cells, and their neighbour lists: scratch that a substep makes from the
// state's rows and that does not outlive it. For each neighbour within the kernel's radius a list holds its
// slot, the gradient of the kernel there, and whatever else the method needs (pair_list.h).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/systems/sph/pair_list.h"
#include "engine/systems/sph/setting.h"

namespace truestep::sph {

/// Cells of at least the kernel's radius over the box, x fastest.
template <int D>
struct Cells {
  double low[3] = {}, width[3] = {}, per_metre[3] = {};
  int count[3] = {1, 1, 1};
  bool wraps[3] = {};
  std::vector<uint32_t> start;

  void set(const SphDef& d, double support) {
    const double lows[3] = {d.low.x, d.low.y, d.low.z}, highs[3] = {d.high.x, d.high.y, d.high.z};
    size_t all = 1;
    for (int a = 0; a < D; ++a) {
      low[a] = lows[a], width[a] = highs[a] - lows[a], wraps[a] = d.wraps(a);
      // A little wider than the radius, to allow for rounding of positions.
      count[a] = std::max(1, static_cast<int>(width[a] / (support * 1.0001)));
      per_metre[a] = count[a] / width[a];
      all *= static_cast<size_t>(count[a]);
    }
    start.assign(all + 1, 0);
  }
  int along(double x, int a) const {
    const double c = (x - low[a]) * per_metre[a];
    return c > 0 ? std::min(static_cast<int>(c), count[a] - 1) : 0;
  }
  size_t of(const int* c) const {
    return (static_cast<size_t>(c[2]) * static_cast<size_t>(count[1]) + static_cast<size_t>(c[1])) *
               static_cast<size_t>(count[0]) +
           static_cast<size_t>(c[0]);
  }
  /// visit(begin, end, shift): runs of slots of the cells around c, and the shift (m) that brings them next
  /// to it.
  template <class Visit>
  void around(const int* c, const Visit& visit) const {
    double shift[3] = {};
    const int reach_z = D == 3 ? 1 : 0;
    for (int z = -reach_z; z <= reach_z; ++z) {
      int at[3] = {0, 0, c[2] + z};
      if (!fold(2, at, shift)) continue;
      for (int y = -1; y <= 1; ++y) {
        at[1] = c[1] + y;
        if (!fold(1, at, shift)) continue;
        const int from = std::max(c[0] - 1, 0), to = std::min(c[0] + 1, count[0] - 1);
        shift[0] = 0;
        run(at, from, to, shift, visit);
        if (!wraps[0]) continue;
        if (c[0] == 0) shift[0] = -width[0], run(at, count[0] - 1, count[0] - 1, shift, visit);
        if (c[0] == count[0] - 1) shift[0] = width[0], run(at, 0, 0, shift, visit);
      }
    }
  }

 private:
  bool fold(int a, int* at, double* shift) const {
    shift[a] = 0;
    if (a >= D || (at[a] >= 0 && at[a] < count[a])) return true;
    if (!wraps[a]) return false;
    const bool below = at[a] < 0;
    at[a] += below ? count[a] : -count[a];
    shift[a] = below ? -width[a] : width[a];
    return true;
  }
  template <class Visit>
  void run(int* at, int from, int to, const double* shift, const Visit& visit) const {
    at[0] = from;
    const size_t first = of(at);
    visit(start[first], start[first + static_cast<size_t>(to - from) + 1], shift);
  }
};

template <int D, class T>
struct Fluid {
  using W = Wide<T>;
  static constexpr size_t kLanes = W::kLanes;

  size_t n = 0;
  T unit = 1;  ///< 1/m, of the gradients in lists
  Cells<D> cells;
  std::vector<uint32_t> row, cell_of, cursor;
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
  std::vector<double> partial;  ///< by chunk or block

  /// Whether nothing moves a particle. It then has no pressure either: others would have to yield in its
  /// place.
  bool fixed(size_t i) const { return weighted && light[i] == 0; }
  T lightness(size_t i) const { return weighted ? light[i] : T{1}; }

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
    row.resize(n), cell_of.resize(n);
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
  /// Sum and maximum of the first numbers that body(slot, chunk, begin, end) returns, none of them negative,
  /// and sums of the second and the third.
  struct Tally {
    double sum = 0, most = 0, second = 0, third = 0;
  };
  template <class Body>
  Tally tally(const ThreadArena& arena, const Body& body) {
    partial.resize(4 * chunks_in_use());
    arena.for_blocks(chunks_in_use(), 4, [&](size_t first, size_t last) {
      for (size_t k = first; k < last; ++k) {
        const Chunk<T>& c = chunks[k];
        const size_t low = k * kChunk, high = std::min(n, low + kChunk);
        Tally part;
        for (size_t i = low; i < high; ++i) {
          const auto [value, second, third] = body(i, c, c.first[i - low], c.first[i - low + 1]);
          part.sum += value, part.second += second, part.third += third;
          if (!(value <= part.most)) part.most = value;
        }
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
