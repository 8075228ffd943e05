// Particles sorted by the blocks of cells that contain them, and the blocks in use: scratch that a step
// builds from the state's rows and discards. Blocks are 8 x 8 cells in the plane and 4 x 4 x 4 in space; a
// block's tile has the block's own nodes and those reached by particles that have moved by less than a cell
// since they were sorted.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/parallel.h"
#include "engine/kernels/mpm/spline.h"
#include "engine/math/wide.h"

namespace truestep::mpm {

template <class T>
using Aligned = std::vector<T, CacheLineAllocator<T>>;

/// All sizes for one dimension and one spline.
template <int D, int Nodes>
struct Tiling {
  static constexpr int kBlock = D == 2 ? 8 : 4;      ///< cells along each axis
  static constexpr int kPad = 2 * kBlock;            ///< cells before the box
  static constexpr int kReach = kBlock + Nodes + 1;  ///< nodes of a tile along each axis
  static constexpr int kRow = kBlock + 5;    ///< nodes of a tile along the last axis, with room for four
  static constexpr size_t kBlockNodes = 64;  // 8 x 8 or 4 x 4 x 4
  static constexpr size_t kTileNodes = D == 2 ? size_t{kReach} * kRow : size_t{kReach} * kReach * kRow;
  static constexpr int kNeighbours = D == 2 ? 9 : 27;
  static constexpr int kSelf = kNeighbours / 2;
};

/// Offsets of a particle's numbers: the components of a group of lanes follow one another.
template <int D>
struct Layout {
  static constexpr int x = 0, v = D, c = 2 * D, f = 2 * D + D * D, plastic = 2 * D + 2 * D * D,
                       jacobian = plastic + 1, tau = plastic + 2, count = tau + D * (D + 1) / 2;
};

template <int D, class T>
struct Sorted {
  static constexpr size_t kLanes = Wide<T>::kLanes;
  static constexpr uint32_t kNone = ~0u;
  static constexpr size_t kCount = Layout<D>::count;
  Aligned<T> data;
  std::vector<uint32_t> row;  ///< of the state; kNone: padding of a group

  size_t slots() const { return row.size(); }
  void resize(size_t n) { data.resize(n * kCount), row.assign(n, kNone); }
  T* group(size_t slot) { return data.data() + slot / kLanes * kCount * kLanes; }
  const T* group(size_t slot) const { return data.data() + slot / kLanes * kCount * kLanes; }
  T& at(size_t slot, int component) {
    return group(slot)[static_cast<size_t>(component) * kLanes + slot % kLanes];
  }
  T at(size_t slot, int component) const {
    return group(slot)[static_cast<size_t>(component) * kLanes + slot % kLanes];
  }
};

/// Slots [begin, end) of one body in one block; `begin` is the start of a group.
struct Run {
  uint32_t block, body;
  size_t begin, end;
};

/// A block in use; without particles of its own it has nodes that those of its neighbours reach. Every
/// velocity field has blocks of its own; those at the same place are consecutive.
struct Block {
  int64_t id = 0;              ///< index of the place, times the number of fields, plus the field
  int at[3] = {};              ///< in blocks
  int32_t tile = -1;           ///< -1: no particles
  size_t first = 0, last = 0;  ///< its runs
  int32_t neighbours[27];      ///< first axis slowest; -1: not in use
};

/// Smallest integer side of a square or cube that holds `many`.
inline double side_of(double many, int dimension) {
  double side = 1;
  while ((dimension == 2 ? side * side : side * side * side) < many) ++side;
  return side;
}

template <int D, int Nodes, class T>
struct Blocks {
  using Size = Tiling<D, Nodes>;
  double low[3] = {}, inverse_dx = 1;
  int extent[3] = {1, 1, 1};   ///< in blocks
  int64_t fields = 1;          ///< velocity fields
  std::vector<int32_t> table;  ///< by id: place in `blocks`, or -1
  std::vector<Block> blocks;
  std::vector<Run> runs;
  std::vector<uint32_t> owners;  ///< blocks with particles, by tile
  std::vector<int64_t> ids, keys;
  std::vector<size_t> counts;

  void set(const Vec3& corner, const Vec3& far, double dx, size_t many_fields) {
    const double lows[3] = {corner.x, corner.y, corner.z}, highs[3] = {far.x, far.y, far.z};
    inverse_dx = 1 / dx, fields = static_cast<int64_t>(many_fields);
    size_t total = many_fields;
    for (int a = 0; a < D; ++a) {
      low[a] = lows[a];
      extent[a] = (static_cast<int>((highs[a] - lows[a]) / dx) + 1 + 2 * Size::kPad) / Size::kBlock + 1;
      total *= static_cast<size_t>(extent[a]);
    }
    table.assign(total, -1);
  }
  /// Position in cells from the first node of the padded grid.
  T place(T x, int axis) const {
    return (x - static_cast<T>(low[axis])) * static_cast<T>(inverse_dx) + static_cast<T>(Size::kPad);
  }
  /// Id of the block in which a particle at x belongs, in a field.
  int64_t block_of(const T* x, size_t field) const {
    int64_t id = 0;
    for (int a = 0; a < D; ++a) {
      id = id * extent[a] + static_cast<int>(place(x[a], a) - Spline<Nodes, T>::kShift) / Size::kBlock;
    }
    return id * fields + static_cast<int64_t>(field);
  }

  /// Reserves memory for n particles spread over four times as many blocks as now (or as `expected`, if that
  /// is more), at most over all blocks.
  void reserve(size_t n, size_t bodies, double expected, Sorted<D, T>& a, Sorted<D, T>& b) {
    const double side = side_of(expected, D) + 2;
    const auto around = static_cast<size_t>(expected > 0 ? (D == 2 ? side * side : side * side * side) : 0);
    const size_t own =
        std::min(table.size(), 4 * std::max(owners.size(), static_cast<size_t>(expected)) + 64);
    const size_t all = std::min(table.size(), 4 * std::max(blocks.size(), around) + 256),
                 most = std::min(n, own * bodies);
    const size_t slots = n + most * (Sorted<D, T>::kLanes - 1);
    owners.reserve(own), blocks.reserve(all), ids.reserve(all), runs.reserve(most);
    counts.reserve(own * bodies + 1), keys.reserve(slots);
    for (Sorted<D, T>* s : {&a, &b}) s->data.reserve(slots * Sorted<D, T>::kCount), s->row.reserve(slots);
  }
  size_t reserved() const { return blocks.capacity(); }
  size_t reserved_owners() const { return owners.capacity(); }

  /// Assigns a slot to each of n particles, in the order of blocks, bodies and input. `keys` are the
  /// particles' blocks (-1: no particle) and become their slots.
  template <class BodyOf, class RowOf>
  void arrange(size_t n, size_t bodies, const BodyOf& body_of, const RowOf& row_of, Sorted<D, T>& to) {
    for (const Block& b : blocks) table[static_cast<size_t>(b.id)] = -1;
    ids.clear(), blocks.clear(), owners.clear();
    int64_t last = -1;
    for (size_t s = 0; s < n; ++s) {
      if (keys[s] < 0 || keys[s] == last || table[static_cast<size_t>(keys[s])] >= 0) continue;
      last = keys[s];
      table[static_cast<size_t>(last)] = 1;
      ids.push_back(last);
    }
    add_blocks();
    counts.assign(owners.size() * bodies + 1, 0);
    for (size_t s = 0; s < n; ++s) {
      if (keys[s] < 0) continue;
      const Block& b = blocks[static_cast<size_t>(table[static_cast<size_t>(keys[s])])];
      keys[s] = static_cast<int64_t>(static_cast<size_t>(b.tile) * bodies + body_of(s));
      ++counts[static_cast<size_t>(keys[s])];
    }
    add_runs(bodies);
    to.resize(counts.back());
    for (size_t s = 0; s < n; ++s) {
      if (keys[s] < 0) continue;
      const size_t slot = counts[static_cast<size_t>(keys[s])]++;
      to.row[slot] = row_of(s);
      keys[s] = static_cast<int64_t>(slot);
    }
  }
  /// Pads groups with copies of their last particle.
  void fill_up(Sorted<D, T>& to) const {
    for (const Run& r : runs) {
      for (size_t s = r.end; s % Sorted<D, T>::kLanes != 0; ++s) {
        for (int c = 0; c < Layout<D>::count; ++c) to.at(s, c) = to.at(r.end - 1, c);
      }
    }
  }

  /// Fills `to` from `from` in the order of blocks, bodies and slots. body_of(row), field_of(row).
  template <class BodyOf, class FieldOf>
  void sort(const Sorted<D, T>& from, Sorted<D, T>& to, size_t bodies, const BodyOf& body_of,
            const FieldOf& field_of, const ThreadArena& arena) {
    const size_t n = from.slots();
    keys.resize(n);
    arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t s = begin; s < end; ++s) {
        keys[s] = -1;
        if (from.row[s] == Sorted<D, T>::kNone) continue;
        T x[3];
        for (int a = 0; a < D; ++a) x[a] = from.at(s, Layout<D>::x + a);
        keys[s] = block_of(x, field_of(from.row[s]));
      }
    });
    arrange(
        n, bodies, [&](size_t s) { return body_of(from.row[s]); }, [&](size_t s) { return from.row[s]; }, to);
    arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t s = begin; s < end; ++s) {
        if (keys[s] < 0) continue;
        for (int c = 0; c < Layout<D>::count; ++c) to.at(static_cast<size_t>(keys[s]), c) = from.at(s, c);
      }
    });
    fill_up(to);
  }

 private:
  template <class Visit>
  void around(const Block& b, const Visit& visit) const {
    const int* at = b.at;
    const int64_t field = b.id % fields;
    int k = 0, p[3] = {};
    for (p[0] = at[0] - 1; p[0] <= at[0] + 1; ++p[0]) {
      for (p[1] = at[1] - 1; p[1] <= at[1] + 1; ++p[1]) {
        if constexpr (D == 2) {
          visit(k++, p, (int64_t{p[0]} * extent[1] + p[1]) * fields + field);
        } else {
          for (p[2] = at[2] - 1; p[2] <= at[2] + 1; ++p[2]) {
            visit(k++, p, ((int64_t{p[0]} * extent[1] + p[1]) * extent[2] + p[2]) * fields + field);
          }
        }
      }
    }
  }
  void locate(Block& b) const {
    int64_t rest = b.id / fields;
    for (int a = D - 1; a >= 0; --a) b.at[a] = static_cast<int>(rest % extent[a]), rest /= extent[a];
  }
  void add_blocks() {
    const size_t own = ids.size();
    for (size_t k = 0; k < own; ++k) {
      Block b{.id = ids[k], .neighbours = {}};
      locate(b);
      around(b, [&](int, const int*, int64_t id) {
        if (table[static_cast<size_t>(id)] >= 0) return;
        table[static_cast<size_t>(id)] = 0;
        ids.push_back(id);
      });
    }
    std::sort(ids.begin(), ids.end());
    for (const int64_t id : ids) {
      Block b{.id = id, .neighbours = {}};
      locate(b);
      if (table[static_cast<size_t>(id)] == 1) {
        b.tile = static_cast<int32_t>(owners.size());
        owners.push_back(static_cast<uint32_t>(blocks.size()));
      }
      blocks.push_back(b);
    }
    for (size_t k = 0; k < blocks.size(); ++k) table[static_cast<size_t>(ids[k])] = static_cast<int32_t>(k);
    for (Block& b : blocks) {
      around(b, [&](int k, const int* p, int64_t id) {
        bool inside = true;
        for (int a = 0; a < D; ++a) inside = inside && p[a] >= 0 && p[a] < extent[a];
        b.neighbours[k] = inside ? table[static_cast<size_t>(id)] : -1;
      });
    }
  }
  /// Turns counts of bodies by tile into the first slots of their runs.
  void add_runs(size_t bodies) {
    constexpr size_t kLanes = Sorted<D, T>::kLanes;
    runs.clear();
    size_t slot = 0;
    for (size_t k = 0; k < owners.size(); ++k) {
      Block& b = blocks[owners[k]];
      b.first = runs.size();
      for (size_t m = 0; m < bodies; ++m) {
        const size_t many = counts[k * bodies + m];
        counts[k * bodies + m] = slot;
        if (many == 0) continue;
        runs.push_back({owners[k], static_cast<uint32_t>(m), slot, slot + many});
        slot += (many + kLanes - 1) / kLanes * kLanes;
      }
      b.last = runs.size();
    }
    counts.back() = slot;
  }
};

}  // namespace truestep::mpm
