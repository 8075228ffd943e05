// Solids as triangles for drawing: hulls, meshes and height fields with their own triangles. A corner's
// normal is the area-weighted mean over the triangles around it that bend by less than the crease angle from
// its own,
//   n = sum over { t : n_t . n_own > cos(crease) } of (b - a) x (c - a),
// so that flat faces stay flat and round ones look round.
#pragma once
#include <memory>
#include <span>

#include "engine/core/drawing.h"
#include "engine/geometry/solid.h"

namespace truestep {

/// Triples of indices into `points`, anticlockwise seen from outside; triangles without area are left out.
std::shared_ptr<const DrawnMesh> creased_mesh(std::span<const Vec3> points,
                                              std::span<const std::array<uint32_t, 3>> triangles);

/// Triangles of a hull, mesh or height field (a grid of more than 512 cells a side is thinned); null for
/// solids that are drawn by their kind and size.
std::shared_ptr<const DrawnMesh> drawn_mesh(const Solid& solid);

/// The solid as it is drawn at a pose. Not for compounds, whose parts are drawn one by one.
DrawnShape drawn_shape(const Solid& solid, const Pose& at);

}  // namespace truestep
