#include "engine/systems/fem/fem_tables.h"

namespace truestep::fem {

const DefTable& quad_table() {
  static const DefTable t =
      TableOf<QuadShape>("four-sided plane body; side x0 runs from the first corner to the last")
          .vectors("corners", &QuadShape::corners, "m", any(), {4, 4}, "anticlockwise in the plane z = 0")
          .integer("cells_x", &QuadShape::cells_x, between(1, 2000), "from the first corner to the second")
          .integer("cells_y", &QuadShape::cells_y, between(1, 2000), "from the first corner to the last")
          .check([](const QuadShape& q, const DefTable::Report& report) {
            for (size_t k = 0; k < q.corners.size(); ++k) {
              const std::string at = "/corners/" + std::to_string(k);
              if (q.corners[k].z != 0) report(at, "a plane body must lie in z = 0");
              if (q.corners.size() < 4) continue;
              const Vec3 in = q.corners[k] - q.corners[(k + 3) % 4],
                         go = q.corners[(k + 1) % 4] - q.corners[k];
              if (!(cross(in, go).z > 0))
                report(at, "corners must run anticlockwise and make a convex shape");
            }
          })
          .build();
  return t;
}

const DefTable& set_table() {
  static const DefTable t =
      TableOf<SetDef>("named set of points, given by indices, by a box or by both")
          .text("name", &SetDef::name, "of the set")
          .required()
          .integers("points", &SetDef::points, at_least(0), {0, 1'000'000}, "indices of nodes")
          .vector("low", &SetDef::low, "m", any(), "lower corner of the box; absent: unbounded below")
          .vector("high", &SetDef::high, "m", any(), "upper corner of the box; absent: unbounded above")
          .build();
  return t;
}

const DefTable& cells_table() {
  static const DefTable t =
      TableOf<CellsShape>("elements of any kind")
          .vectors("vertices", &CellsShape::vertices, "m", any(), {3, 1'000'000}, "positions of the corners")
          .required()
          .integers("cells", &CellsShape::cells, at_least(0), {3, 8'000'000},
                    "corners of every element, one after another, in VTK's order: 3 per triangle, 4 per quad "
                    "or tetrahedron, 8 per hexahedron; nodes between them are added")
          .required()
          .choice("form", &CellsShape::form,
                  {"as_element", "triangles", "quadrangles", "tetrahedra", "hexahedra"},
                  "kind of the cells, as in mesh files")
          .objects("sets", &CellsShape::sets, set_table(), {0, 10'000},
                   "named sets of vertices, such as the groups of a mesh file")
          .build();
  return t;
}

const DefTable& fill_table() {
  static const DefTable ball = TableOf<BallRegion>("ball")
                                   .vector("center", &BallRegion::center, "m", any(), "of the ball")
                                   .number("radius", &BallRegion::radius, "m", above(0), "of the ball")
                                   .build();
  static const DefTable cylinder =
      TableOf<CylinderRegion>("cylinder with flat ends")
          .vector("from", &CylinderRegion::from, "m", any(), "centre of one end")
          .vector("to", &CylinderRegion::to, "m", any(), "centre of the other end")
          .number("radius", &CylinderRegion::radius, "m", above(0), "of the cylinder")
          .check([](const CylinderRegion& c, const DefTable::Report& report) {
            if (!(norm2(c.to - c.from) > 0)) report("/to", "a cylinder needs a length above 0");
          })
          .build();
  static const DefTable t =
      TableOf<FillShape>(
          "region to fill with tetrahedra (isosurface stuffing); features finer than the spacing are rounded "
          "off")
          .object("ball", &FillShape::ball, ball, "a ball")
          .object("cylinder", &FillShape::cylinder, cylinder, "a cylinder")
          .object("surface", &FillShape::surface, mesh_shape_table(),
                  "the inside of closed surfaces whose triangles are oriented consistently")
          .number("spacing", &FillShape::spacing, "m", above(0), "of the lattice of elements")
          .build();
  return t;
}

const DefTable& copy_table() {
  static const DefTable t =
      TableOf<CopyDef>("a copy of this shape, rotated about the origin, then translated")
          .vector("position", &CopyDef::position, "m", any(), "of the translation")
          .vector("axis", &CopyDef::axis, "1", any(), "of the rotation")
          .number("angle", &CopyDef::angle, "rad", any(), "of the rotation")
          .vector("velocity", &CopyDef::velocity, "m/s", any(), "initial, added to that of the system")
          .check([](const CopyDef& c, const DefTable::Report& report) {
            if (!(norm2(c.axis) > 0)) report("/axis", "an axis needs a length above 0");
          })
          .build();
  return t;
}

const DefTable& hold_table() {
  static const DefTable t =
      TableOf<HoldDef>(
          "displacement of a set from its rest position, in m: expressions of t, X, Y, Z (the rest "
          "position); an absent component is free; if none is given, all are fixed at 0")
          .text("on", &HoldDef::on, "name of a set")
          .required()
          .expression("x", &HoldDef::x, "m, number or expression")
          .expression("y", &HoldDef::y, "m, the same")
          .expression("z", &HoldDef::z, "m, the same")
          .build();
  return t;
}

const DefTable& load_table() {
  static const DefTable t =
      TableOf<LoadDef>("load on the part of the surface whose nodes are all in a set")
          .text("on", &LoadDef::on, "name of a set")
          .required()
          .vector("force", &LoadDef::force, "N", any(),
                  "total, spread evenly over the undeformed area; keeps its direction")
          .expression("x", &LoadDef::x,
                      "Pa, force along x per undeformed area: number or expression of X, Y, Z")
          .expression("y", &LoadDef::y, "Pa, the same along y")
          .expression("z", &LoadDef::z, "Pa, the same along z")
          .number("pressure", &LoadDef::pressure, "Pa", any(),
                  "on the deformed surface, against its current normal")
          .build();
  return t;
}

}  // namespace truestep::fem
