// The order in which constraints are solved. Constraints of one colour share no point, so a colour is solved
// lane by lane on any number of threads with the same bits. Links are joined into chains, paths as straight
// as possible, and a chain is solved directly (kernels/xpbd/chain.h): the rows of a grid are one colour, the
// columns the next. Measured on a hanging cloth of 100 x 100 against single links: 0.003 % of stretch instead
// of 4 % at 10 substeps.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "engine/systems/xpbd/tearing/tear_surface.h"

namespace truestep::xpbd {

inline constexpr uint32_t kNobody = UINT32_MAX;

/// As many chains as there are lanes, the longest first; entries are interleaved by lane.
struct ChainBatch {
  uint32_t links;      ///< of the longest
  size_t first_link;   ///< in ChainSchedule::link
  size_t first_point;  ///< in ChainSchedule::points
};

/// Batches [begin, end), and their longest chain.
struct Colour {
  size_t begin, end;
  uint32_t longest = 1;
};

struct ChainSchedule {
  std::vector<uint32_t> points, link;  ///< rows; links of the body, kNobody where a lane is padding
  std::vector<ChainBatch> batches;
  std::vector<Colour> colours;
};

/// Constraints on N points, one per lane; batch b has entries b lanes ... (b + 1) lanes.
struct SetSchedule {
  std::vector<uint32_t> points;  ///< N x lanes per batch
  std::vector<uint32_t> member;  ///< lanes per batch; kNobody where a lane is padding
  std::vector<Colour> colours;   ///< ranges of batches
};

struct Schedule {
  /// `tears`: null if nothing can tear.
  Schedule(const Body& body, Sweep sweep, int lanes, const TearSurface* tears = nullptr);

  int lanes;
  size_t rows;  ///< points, then one row without inverse mass for each batch with padding
  ChainSchedule chains;
  SetSchedule rods, hinges, angles, volumes, sheet;
  ChainSchedule strands;  ///< single links: the strands that tearing may make of each link
  std::vector<std::array<uint32_t, 2>> strand_of;  ///< link and side of a strand
  size_t spare_rows = 0;  ///< one row without inverse mass for every batch of strands
};

}  // namespace truestep::xpbd
