// What a solver keeps of Cosserat rods within a step: constants packed lane by lane, frames and their spins.
// A substep turns frames by their spins (by Cayley's map, rod_strain.h), solves each rod directly and takes
// spins from how far frames have turned. The gyroscopic moment w x I w is left out: a section's inertia is
// r^2 / l^2 of what the points give to its link.
#pragma once
#include <vector>

#include "engine/base/cache_line.h"
#include "engine/core/system.h"
#include "engine/kernels/xpbd/rod.h"
#include "engine/systems/xpbd/rods/rod_set.h"

namespace truestep::xpbd {

class RodSolver {
 public:
  /// `spare`: a row of a point without inverse mass, for lanes that have no rod.
  void prepare(const RodSet& rods, size_t spare, bool keeps);
  /// Frames, spins, clamps and lengths at the step's start.
  void load(const RodSet& rods, const State& state);
  /// Turns frames for a substep of h.
  void predict(const RodSet& rods, double h, const ThreadArena& arena);
  /// Strains at a substep's start, before points and frames move; does nothing if rods are undamped.
  void measure(const RodSet& rods, const double* rows, const ThreadArena& arena);
  void forget_multipliers();
  /// Returns the largest q.
  double solve(const RodSet& rods, double h, double* rows, const ThreadArena& arena);
  void find_spins(const RodSet& rods, double h, const ThreadArena& arena);
  void store(const RodSet& rods, State& state) const;

 private:
  template <class U>
  using Column = std::vector<U, CacheLineAllocator<U>>;
  static constexpr auto kLanes = static_cast<size_t>(Wide<double>::kLanes);
  Rods<double> batch(const RodSet& rods, size_t b, double gamma);
  size_t batches(const RodSet& rods) const { return (rods.rods + kLanes - 1) / kLanes; }

  std::vector<uint32_t> points_, frames_of_;
  Column<double> base_, per_length_, joint_per_length_, rest_, stretch_, bend_, strains_, lambda_;
  Column<double> frames_, old_frames_, spins_, inverse_inertia_;  // rows of 4
  std::vector<RodScratch<double>, CacheLineAllocator<RodScratch<double>>> scratch_;
  std::vector<double> q_;  // per batch
};

}  // namespace truestep::xpbd
