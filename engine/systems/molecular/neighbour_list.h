// Pairs that may be within the cut-off until an atom has moved by half a skin (Verlet 1967): for every atom
// the rows of atoms and periodic images within cut-off + skin of where they were at the reference positions.
// The list is a function of those positions and the box alone, so a restored state builds the same one. Atoms
// are sorted by cell; images are rows of their own, so that loops over pairs need not know the box.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/base/parallel.h"
#include "engine/kernels/molecular/pair_law.h"
#include "engine/neighbours/point_grid.h"
#include "engine/systems/molecular/cell.h"

namespace truestep::molecular {

/// Excluded pairs: those of atom i are partners[begin[i]] ... partners[begin[i + 1]], ascending.
struct Exclusions {
  std::vector<uint32_t> begin, partners;
  bool empty() const { return partners.empty(); }
};

/// What a list is made for; must outlive it.
struct ListSetting {
  double reach = 1;  ///< m, cut-off + skin
  std::vector<uint32_t> kinds;
  std::vector<double> charges;  ///< C
  Exclusions exclusions;
};

class NeighbourList {
 public:
  static constexpr size_t kBlock = 256;  ///< atoms

  /// Builds the list for these positions (n x 3, m, in any image), unless it exists already.
  void update(const ListSetting& setting, std::span<const double> reference, const Cell& cell,
              const ThreadArena& arena);
  /// Updates the rows to the atoms' present positions; they have moved less than half a skin.
  void place(const double* x, const ThreadArena& arena);

  PairRows rows() const { return {rows_.data(), kinds_.data()}; }
  /// Number of atoms, in cell order.
  size_t size() const { return centres_.size(); }
  struct Entry {
    uint32_t atom, row;
    const uint32_t* list;
    size_t count;  ///< a multiple of four; the last ones may be dummies
  };
  Entry entry(size_t k) const {
    const Range r = ranges_[k];
    return {owner_[centres_[k]], centres_[k], blocks_[k / kBlock].data() + r.begin, r.count};
  }
  /// Atom of a row, and the offset of its position; the row after the last is a far dummy.
  uint32_t owner(size_t row) const { return owner_[row]; }
  size_t owners() const { return owner_.size(); }

 private:
  struct Range {
    uint32_t begin, count;
  };
  void add_images(const ListSetting& setting, std::span<const double> reference, const Cell& cell);
  void sort(const ListSetting& setting, const ThreadArena& arena);
  void find(const ListSetting& setting, size_t begin, size_t end);
  size_t keep_allowed(const ListSetting& setting, uint32_t atom, uint32_t* list, size_t count) const;

  std::vector<double, CacheLineAllocator<double>> reference_, rows_;
  Cell cell_;
  double reach_ = 0;
  PointGrid grid_;
  // Before sorting: positions, owners and offsets of atoms (first) and images.
  std::vector<double> points_, offsets_;
  std::vector<uint32_t> atoms_;
  // By row.
  std::vector<uint32_t> owner_, kinds_;
  std::vector<double> shift_, px_, py_, pz_;
  std::vector<uint32_t> centres_;
  std::vector<Range> ranges_;
  std::vector<std::vector<uint32_t>> blocks_;
};

}  // namespace truestep::molecular
