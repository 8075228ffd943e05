// The tables of meshes and height fields in "colliders".
#include <algorithm>

#include "engine/collision/points/collider_def.h"
#include "engine/geometry/make/enclosure.h"

namespace truestep {
namespace {

const DefTable& mesh_collider_table() {
  static const DefTable t = [] {
    using D = MeshColliderDef;
    TableOf<D> table("triangles that enclose a volume, rotated by an angle about an axis");
    table.vectors("vertices", &D::vertices, "m", any(), {4, 1'000'000}, "corners, relative to the centre")
        .required()
        .integers("triangles", &D::triangles, at_least(0), {12, 6'000'000},
                  "three vertex indices each, anticlockwise seen from outside of the volume, of a container "
                  "too; every edge belongs to two triangles")
        .required()
        .vector("center", &D::center, "m", any(), "where the mesh's origin is at t = 0")
        .vector("axis", &D::axis, "1", any(), "axis of its rotation; any length")
        .number("angle", &D::angle, "rad", any(), "angle of its rotation");
    add_collider_common(add_collider_container(table));
    return table
        .check([](const D& d, const DefTable::Report& report) {
          const auto fault = enclosure_fault(d.vertices, d.triangles);
          if (!fault) return;
          const bool whole = fault->index >= d.triangles.size();
          report(whole ? "/triangles" : "/triangles/" + std::to_string(fault->index), fault->what);
        })
        .build();
  }();
  return t;
}

const DefTable& ground_table() {
  static const DefTable t = [] {
    using D = HeightFieldColliderDef;
    TableOf<D> table(
        "ground below heights along y on a grid; beyond the grid it goes on as high as at its border");
    table.integers("count", &D::count, between(2, 4096), {2, 2}, "points along x and z")
        .required()
        .number("spacing", &D::spacing, "m", above(0), "from point to point")
        .numbers("heights", &D::heights, "m", any(), {4, 10'000'000}, "count[0] x count[1], x fastest")
        .required()
        .vector("center", &D::center, "m", any(), "where the middle of the grid is, at height 0");
    add_collider_surface(table);
    return table
        .check([](const D& d, const DefTable::Report& report) {
          if (d.count.size() != 2) return;
          if (static_cast<int64_t>(d.heights.size()) != d.count[0] * d.count[1]) {
            report("/heights", "must have count[0] x count[1] = " + std::to_string(d.count[0] * d.count[1]) +
                                   " numbers, not " + std::to_string(d.heights.size()));
          }
        })
        .build();
  }();
  return t;
}

}  // namespace

ColliderVariants any_collider_variants() {
  ColliderVariants out = collider_variants();
  out.emplace_back("mesh", &mesh_collider_table());
  out.emplace_back("height_field", &ground_table());
  return out;
}

}  // namespace truestep
