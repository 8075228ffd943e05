// Speeds that a liquid must be prepared for before it has them: those of its start, of nozzles and moving
// walls, and of the fall from there.
#pragma once
#include <span>

#include "engine/systems/sph/mesh_wall.h"

namespace truestep::sph {

/// m/s, the largest that the start, the emitters and the moving walls lead to: v^2 + 2 g H with the largest
/// speed v of any of them and the height H from the highest of the liquid and the nozzles to the lowest place
/// that liquid can reach. `fastest_initial` (m/s) is that of the velocities given as expressions.
double expected_speed(const SphDef& def, const ColliderSet& colliders, std::span<const MeshWall> meshes,
                      const Vec3& gravity, double fastest_initial);

/// m/s, bound on the speed of any point of the colliders and the lid that drag or push liquid between times t
/// and t + h (s).
double fastest_wall(const SphDef& def, const ColliderSet& colliders, std::span<const MeshWall> meshes,
                    double t, double h);

}  // namespace truestep::sph
