// The direction to a goal around walls: straight if nothing is in between, otherwise along the descent of the
// walking time T,
//   |grad T| = 1 / F,  F = 1 but slower within `clearance` of walls,
// by fast marching from the nodes that see the goal (Sethian 1996, PNAS 93:1591), of first order. Built once.
#pragma once
#include <memory>
#include <vector>

#include "engine/systems/crowd/walls.h"

namespace truestep::crowd {

/// The grid shared by all goals, and its nodes' distances from walls.
struct WayGrid {
  WayGrid(const CrowdDef& def, const Walls& walls);

  double h;  ///< m
  Vec3 low;
  long nx, ny;
  std::vector<float> room;  ///< m, to the nearest wall
  Vec3 place(size_t node) const {
    const long i = static_cast<long>(node), column = i % nx, row = i / nx;
    return low + Vec3{static_cast<double>(column), static_cast<double>(row), 0} * h;
  }
  /// Nodes this close to a wall count as inside it: no path leads over them, nor between two others across
  /// it.
  bool solid(size_t node) const { return room[node] <= 0.51 * h; }
};

class Navigation {
 public:
  /// Without walls `grid` may be null.
  Navigation(const Goal& goal, const WayGrid* grid, const Walls& walls, double clearance);

  const Goal& goal() const { return goal_; }
  /// Unit direction to walk in at x; zero at the goal.
  Vec3 direction(const Vec3& x) const;
  /// s at 1 m/s from near x to the goal; infinite if no path leads there.
  double time(const Vec3& x) const;

 private:
  void look(double clearance);
  void march(double clearance);
  double arrival(size_t node, double slowness) const;
  void descend();

  Goal goal_;
  const WayGrid* grid_;
  const Walls& walls_;
  std::vector<float> time_;
  std::vector<uint8_t> sees_;
  std::vector<float> way_;  ///< 2 per node
};

}  // namespace truestep::crowd
