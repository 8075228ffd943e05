// Nodes between blocks and the tiles of the particles' blocks: a tile has the nodes of its own block and of
// the rims of those around it. Sums run over the tiles in the order of neighbours, whatever thread takes
// them.
#pragma once
#include <cstring>

#include "engine/systems/mpm/blocks.h"

namespace truestep::mpm {

namespace tiles_detail {
// Not members of the template, as in math/wide.h.
template <class T>
struct FourOf;
template <>
struct FourOf<float> {
  typedef float Raw __attribute__((vector_size(16)));
};
template <>
struct FourOf<double> {
  typedef double Raw __attribute__((vector_size(32)));
};

/// Adds `from` to `to`, four numbers.
template <class T>
void add_four(T* to, const T* from) {
  typename FourOf<T>::Raw a, b;
  std::memcpy(&a, to, sizeof a), std::memcpy(&b, from, sizeof b);
  a += b;
  std::memcpy(to, &a, sizeof a);
}
template <class T>
void copy_four(T* to, const T* from) {
  std::memcpy(to, from, 4 * sizeof(T));
}
}  // namespace tiles_detail

template <int D, int Nodes, class T>
struct Tiles {
  using Size = Tiling<D, Nodes>;
  static constexpr size_t kBlockNumbers = 4 * Size::kBlockNodes, kTileNumbers = 4 * Size::kTileNodes;

  /// Rows of nodes shared by a block and its neighbour's tile: visit(first number in the block, first number
  /// in the tile, count). `k` is the neighbour's index.
  template <class Visit>
  static void shared_rows(int k, const Visit& visit) {
    int from[3] = {}, to[3] = {1, 1, 1}, shift[3] = {};
    for (int a = D - 1; a >= 0; --a, k /= 3) {
      shift[a] = 1 - (k % 3 - 1) * Size::kBlock;
      from[a] = std::max(0, -shift[a]);
      to[a] = std::min(Size::kBlock, Size::kReach - shift[a]);
      if (from[a] >= to[a]) return;
    }
    const auto many = static_cast<size_t>(4 * (to[D - 1] - from[D - 1]));
    for (int i = from[0]; i < to[0]; ++i) {
      if constexpr (D == 2) {
        visit(static_cast<size_t>(4 * (i * Size::kBlock + from[1])),
              static_cast<size_t>(4 * ((i + shift[0]) * Size::kRow + from[1] + shift[1])), many);
      } else {
        for (int j = from[1]; j < to[1]; ++j) {
          visit(static_cast<size_t>(4 * ((i * Size::kBlock + j) * Size::kBlock + from[2])),
                static_cast<size_t>(
                    4 * (((i + shift[0]) * Size::kReach + j + shift[1]) * Size::kRow + from[2] + shift[2])),
                many);
        }
      }
    }
  }

  /// Sums the nodes of a block from the tiles around it.
  static void sum(const Blocks<D, Nodes, T>& blocks, const Block& b, const Aligned<T>& from, T* own) {
    std::fill(own, own + kBlockNumbers, T{0});
    for (int m = 0; m < Size::kNeighbours; ++m) {
      if (b.neighbours[m] < 0) continue;
      const Block& other = blocks.blocks[static_cast<size_t>(b.neighbours[m])];
      if (other.tile < 0) continue;
      const T* tile = from.data() + static_cast<size_t>(other.tile) * kTileNumbers;
      shared_rows(m, [&](size_t to, size_t at, size_t many) {
        for (size_t i = 0; i < many; i += 4) tiles_detail::add_four(own + to + i, tile + at + i);
      });
    }
  }

  /// Copies the nodes around a block into `tile`, which starts as zeros or as any other block's tile.
  static void fill(const Block& b, const Aligned<T>& from, T* tile) {
    for (int m = 0; m < Size::kNeighbours; ++m) {
      const T* other =
          b.neighbours[m] < 0 ? nullptr : from.data() + static_cast<size_t>(b.neighbours[m]) * kBlockNumbers;
      // Seen from the neighbour, this block is on the opposite side.
      shared_rows(Size::kNeighbours - 1 - m, [&](size_t at, size_t to, size_t many) {
        if (!other) {
          std::fill(tile + to, tile + to + many, T{0});
        } else {
          for (size_t i = 0; i < many; i += 4) tiles_detail::copy_four(tile + to + i, other + at + i);
        }
      });
    }
  }
};

}  // namespace truestep::mpm
