// Neighbour lists of one cell's particles, sixteen floats at once: loops for processors with AVX-512, chosen
// when the program runs. They make the lists of systems/sph/neighbours.h, to the bit, where the slots around
// a cell ascend and span at most 2^15.
#pragma once
#include <cstddef>
#include <cstdint>

#include "engine/kernels/sph/smoothing_values.h"

namespace truestep::sph {

/// Consecutive slots, and the shift that brings them next to a cell.
struct SlotRun {
  size_t begin, end;
  double shift[3];  ///< m
};

/// A particle's neighbours: offsets (m), squared distances (m^2) and slots.
struct Found {
  float *way[3], *squares;
  uint32_t* slots;
};

/// Input of the loops. Scratch has room for the slots of all runs and sixteen more, and begins with a cache
/// line.
struct ListInput {
  const float* x[3];    ///< m, of all particles
  const float* light;   ///< 1, of all particles; nullptr: 1 everywhere
  const SlotRun* runs;  ///< slots of the cell and of those around it
  size_t run_count;
  float low[3], top[3];                ///< m, corners of the box around the cell's particles
  float square;                        ///< m^2, of the kernel's radius
  float inverse;                       ///< 1/m, of the kernel's radius
  float kernel_w, kernel_s, per_unit;  ///< 1, 1/m^2, m
  float* around[3];
  uint32_t* around_slots;
  Found found[2];
};

/// Sums over a list, in eight lanes.
struct ListSums {
  float density[8], squares[8], pull[3][8];
};

/// Output of the loops. Entries are groups of eight rows of four: gradient and slot over the group's first.
struct ListOutput {
  static constexpr size_t kMost = 16;  ///< lists that one call makes
  int16_t* groups;
  uint32_t* base;                       ///< of each group
  float *slopes, *weights, *distances;  ///< of each entry; nullptr: not kept
  size_t used, room;                    ///< entries
  uint32_t ends[kMost];                 ///< `used` after each list
  ListSums sums[kMost];
};

struct CellLoops {
  /// Collects the slots within the kernel's radius of the box, in ascending order, padded with far points to
  /// a multiple of sixteen; returns their number without padding.
  size_t (*around)(const ListInput&);
  /// Appends the lists of the particles from `first` to `stop`, at least one and as long as there is room for
  /// `count` entries and sixteen more; returns how many.
  size_t (*lists)(const ListInput&, size_t count, size_t first, size_t stop, ListOutput&);
};

/// Loops of this kernel and dimension; nullptr where the processor has no AVX-512.
const CellLoops* wide_cell_loops(Smoothing kernel, int dimension);

}  // namespace truestep::sph
