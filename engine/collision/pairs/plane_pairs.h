// A half space against every convex solid and against meshes: the corners, rim points or ball that reach
// below its surface.
#pragma once
#include "engine/collision/pairs/convex.h"
#include "engine/collision/pairs/manifold.h"

namespace truestep {

/// Half space below the plane through the origin with the given unit normal, which is also the manifold's. b
/// relative to the plane's frame; points at most `margin` (m) above it; out.count = 0: none.
void collide_plane(const Vec3& normal, const Convex& b, const Transform& b_in_a, double margin,
                   Manifold& out);

/// The same with the vertices of a mesh: the deepest, and those that reach furthest in eight directions along
/// the plane, of which the best four stay.
void collide_plane_mesh(const Vec3& normal, const TriangleMesh& mesh, const Transform& mesh_in_a,
                        double margin, Manifold& out);

}  // namespace truestep
