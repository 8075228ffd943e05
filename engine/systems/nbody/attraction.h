// Accelerations and potential of all bodies by the method that the def selects: all pairs in doubles or
// mostly in floats, a tree, or the fast multipole method.
#pragma once
#include <vector>

#include "engine/core/state/workspace.h"
#include "engine/kernels/gravity/fast_multipole.h"
#include "engine/systems/nbody/groups.h"

namespace truestep::nbody {

class Attraction {
 public:
  explicit Attraction(const NbodyDef& def) : def_(def) {}

  /// a (n x 3, m/s^2) of bodies at x (n x 3, m).
  void accelerations(const State& s, std::span<const double> x, std::span<double> a, Workspace& workspace,
                     const ThreadArena& arena) const;
  /// J; with the tree, to the accuracy of its sums.
  double potential(const State& s, std::span<const double> x, Workspace& workspace,
                   const ThreadArena& arena) const;
  /// Why n bodies are summed this way, for the plan.
  std::string reason(size_t n) const;

 private:
  gravity::TreeSettings settings(const State& s) const;
  void tree_sums(const gravity::Bodies& bodies, const State& s, const gravity::TreeSums& out,
                 Workspace& workspace, const ThreadArena& arena) const;

  NbodyDef def_;
};

/// m/s^2, mutual attraction of bodies.
std::vector<Vec3> attraction_at_start(const std::vector<Body>& bodies, const NbodyDef& def);

}  // namespace truestep::nbody
