// A collider of triangles as a wall for the liquid: its distance is exact, the share of a kernel behind it
// comes from a map (volume_map.h).
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "engine/collision/points/solid_collider.h"
#include "engine/kernels/sph/half_space.h"
#include "engine/systems/sph/repeated.h"
#include "engine/systems/sph/volume_map.h"

namespace truestep::sph {

struct MeshWall {
  SolidCollider collider;
  std::shared_ptr<const VolumeMap> map;
  Images images = {};
  double radius = 0;  ///< m, of a ball about its origin

  struct Surface {
    double distance = 0;  ///< m, negative behind the surface
    Vec3 normal;          ///< into the liquid
  };
  /// f(place) for x as each image sees it that reaches within `reach` (m) of it at time t.
  template <class F>
  void each_place(const Vec3& x, double t, double reach, const F& f) const {
    if (!images.any()) return f(x);
    const double near = radius + reach;
    images.each(x - moved(collider.start, collider.motion, t).position, {near, near, near},
                [&](const Vec3& shift) { f(x - shift); });
  }
  /// The nearest surface at time t; empty beyond `in_front` (m) in front of it, and beyond `behind` (m), at
  /// most the kernel's radius, behind it.
  std::optional<Surface> surface(const Vec3& x, double t, double in_front, double behind) const;

  struct At {
    Surface surface;
    double share = 0;   ///< 1, of the kernel
    Vec3 slope;         ///< 1/m, into the wall
    double full = 1;    ///< 1, the slope across the surface over that of a flat wall
    Vec3 velocity;      ///< m/s
    Symmetric3 across;  ///< 1, in the mesh's axes: `leaning` of walls.h over the weight
    Rotation axes;

    /// m/s^2, effect of the weight of a fluid at rest (walls.h).
    Vec3 lean(const Vec3& gravity) const { return -axes.apply(across * axes.apply_inverse(gravity)); }
  };
  /// Empty where no part of the kernel is behind the wall.
  std::optional<At> at(const Vec3& x, double t, const HalfSpace& table, double support) const;
};

/// The walls of the colliders that are meshes or height fields.
std::vector<MeshWall> build_mesh_walls(const SphDef& def);
/// Reports such colliders in plane systems, and those that are too large for a map.
void check_mesh_walls(const SphDef& def, const DefTable::Report& report);
/// Bytes of their maps, at most.
double bytes_of_mesh_walls(const SphDef& def);
/// Removes the places that are behind a wall: as much liquid starts in front of it as there is room.
void leave_dry(const SphDef& def, const std::vector<MeshWall>& walls, std::vector<Vec3>& places);

}  // namespace truestep::sph
