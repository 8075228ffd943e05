// Cloth: grids with structural, shear and bending springs (Provot 1995), meshes with springs along edges and
// between the corners opposite an edge, and free networks.
#include <algorithm>

#include "engine/systems/mass_spring/network.h"

namespace truestep::mass_spring {

namespace {

constexpr double kFromPositions = -1;  // rest length still to be measured

}  // namespace

void build_cloth_grid(const ClothGridShape& shape, const MassSpringDef& def, Network& out) {
  ClothGrid grid = make_cloth_grid(shape);
  out.x = std::move(grid.x), out.share = std::move(grid.share), out.triangles = std::move(grid.triangles);
  // Family by family and direction by direction: successive springs then join successive points at both ends.
  const auto add = [&](SpringFamily family, int di, int dj) {
    for (const auto& p : grid_pairs(shape, di, dj))
      out.springs.push_back({p[0], p[1], family, kFromPositions, 1});
  };
  add(SpringFamily::structural, 1, 0);
  add(SpringFamily::structural, 0, 1);
  if (def.shear_stiffness > 0 && shape.shear != ShearSprings::none) {
    add(SpringFamily::shear, 1, 1);
    if (shape.shear == ShearSprings::both) add(SpringFamily::shear, -1, 1);
  }
  if (def.bending_stiffness > 0) {
    add(SpringFamily::bending, 2, 0);
    add(SpringFamily::bending, 0, 2);
  }
  if (def.flexural_rigidity > 0) {
    for (const PlateRod& rod : plate_rods(shape)) {
      out.bends.push_back(
          {rod.points, rod.weight * def.flexural_rigidity * out.share[rod.points[1]] / rod.length2});
    }
  }
}

void build_mesh(const MeshShape& shape, const MassSpringDef& def, Network& out) {
  out.x = shape.vertices;
  out.share = mesh_shares(shape);
  out.triangles = mesh_triangles(shape);
  const auto edges = sorted_edges(out.triangles);
  for (size_t i = 0; i < edges.size(); ++i) {
    const auto& e = edges[i];
    if (i == 0 || edges[i - 1][0] != e[0] || edges[i - 1][1] != e[1]) {
      out.springs.push_back({e[0], e[1], SpringFamily::structural, kFromPositions, 1});
    }
  }
  if (!(def.bending_stiffness > 0)) return;
  for (size_t i = 1; i < edges.size(); ++i) {
    const auto &e = edges[i], &before = edges[i - 1];
    if (e[0] != before[0] || e[1] != before[1] || e[2] == before[2]) continue;
    out.springs.push_back(
        {std::min(e[2], before[2]), std::max(e[2], before[2]), SpringFamily::bending, kFromPositions, 1});
  }
}

void build_free(const FreeShape& shape, Network& out) {
  out.x = shape.points;
  out.v = shape.velocities;
  out.share.assign(out.x.size(), 0);
  for (const FreeSpring& s : shape.springs) {
    out.springs.push_back({static_cast<uint32_t>(s.a), static_cast<uint32_t>(s.b),
                           s.stiffness ? SpringFamily::own : SpringFamily::structural,
                           s.rest_length.value_or(kFromPositions), s.stiffness.value_or(1)});
  }
}

}  // namespace truestep::mass_spring
