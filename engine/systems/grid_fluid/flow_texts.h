// The expressions of a scene on a staggered grid, compiled: velocities at the start and on sides, exact
// velocities, forces, and what the flow carries.
#pragma once
#include <string>
#include <vector>

#include "engine/kernels/mac/ghosts.h"
#include "engine/math/expression/rows.h"
#include "engine/systems/grid_fluid/grid_fluid_def.h"

namespace truestep::grid_fluid {

/// One text, compiled as a function of t, x, y, z.
struct Program {
  ExpressionRows rows;
  bool time = false, zero = true;
};

/// Poses and velocities of obstacles at a time.
struct ObstaclePlaces {
  std::vector<ObstacleDef> obstacles;  ///< with `center` and `turned` for this time
  std::vector<Vec3> velocity;          ///< m/s
  std::vector<Vec3> spin;              ///< rad/s
};

class FlowTexts {
 public:
  /// Error "scene_invalid" with every fault.
  FlowTexts(const GridFluidDef& def, const mac::MacGrid& grid);

  std::array<Program, 3> initial, force, exact;
  Program scalar_initial, scalar_source, second_where;
  std::array<std::array<std::array<Program, 3>, 2>, 3> sides;  ///< [axis][end][component]
  bool has_exact = false, forced = false, sides_move = false, obstacles_move = false, obstacles_turn = false;

  /// The scene's obstacles at time t (s); allocates the first time.
  void place_obstacles(const std::vector<ObstacleDef>& start, double t, ObstaclePlaces& out) const;

  /// u = program at the grid's own values of `place`.
  void sample(const Program& program, const mac::MacGrid& grid, size_t place, double t, double* u,
              const ThreadArena& arena = ThreadArena()) const;
  /// Values of one component on a side's padded plane.
  void sample_side(const mac::MacGrid& grid, size_t axis, size_t end, size_t component, double t,
                   std::vector<double>& out) const;

 private:
  /// Per obstacle and axis the displacement, then the angle; each with its derivative.
  std::vector<std::array<ExpressionRows, 4>> motion_;
};

}  // namespace truestep::grid_fluid
