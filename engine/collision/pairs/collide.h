// Contacts of two bodies: dispatches every pair of solids to its kernel.
//
//            sphere   capsule   box    cylinder  hull   triangle  plane
//   sphere   closed forms ............................................
//   capsule            closed   axis distance / separating axes  closed
//   box                        SAT     GJK/EPA   SAT      SAT    closed
//   cylinder                           GJK/EPA GJK/EPA  GJK/EPA  closed
//   hull                                         SAT      SAT    closed
// Hulls with many edges are treated like cylinders. Meshes, height fields and compounds query their trees for
// the parts near the other body; a mesh collides with a plane by its vertices.
#pragma once
#include <vector>

#include "engine/collision/pairs/convex.h"
#include "engine/collision/pairs/manifold.h"

namespace truestep {

/// Contact of two convex solids or a plane and a convex solid, in the world. Points at most `margin` (m >= 0)
/// apart are returned with positive separation (speculative contacts). False when there is none.
bool collide(const Solid& a, const Transform& at_a, const Solid& b, const Transform& at_b, double margin,
             Manifold& out);

/// The same for any two solids; appends one manifold for every pair of parts that touch, with part_a and
/// part_b set and mixed into the points' ids, in an order that depends on the solids alone. Triangles touched
/// along one normal form one manifold, named after the first of them. Surfaces (planes, meshes, height
/// fields) do not collide with one another, except a mesh with a plane. No allocation once `out` is large
/// enough. Returns the number of appended manifolds.
size_t collide(const Solid& a, const Transform& at_a, const Solid& b, const Transform& at_b, double margin,
               std::vector<Manifold>& out);

/// In a's frame, for kinds with a.kind >= b.kind and b convex; the plane's normal is a.size.
void collide_local(const Convex& a, const Convex& b, const Transform& b_in_a, double margin, Manifold& out);

}  // namespace truestep
