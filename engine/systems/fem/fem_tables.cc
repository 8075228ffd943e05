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
              if (q.corners[k].z != 0) report(at, "a plane body lies in z = 0");
              if (q.corners.size() < 4) continue;
              const Vec3 in = q.corners[k] - q.corners[(k + 3) % 4],
                         go = q.corners[(k + 1) % 4] - q.corners[k];
              if (!(cross(in, go).z > 0)) report(at, "corners go round anticlockwise, none of them inward");
            }
          })
          .build();
  return t;
}

const DefTable& set_table() {
  static const DefTable t =
      TableOf<SetDef>("points with a name, given one by one or by a box or both")
          .text("name", &SetDef::name, "of the set")
          .required()
          .integers("points", &SetDef::points, at_least(0), {0, 1'000'000}, "indices of nodes")
          .vector("low", &SetDef::low, "m", any(), "smallest corner of the box; absent: it has no lower end")
          .vector("high", &SetDef::high, "m", any(), "largest corner of the box; absent: it has no upper end")
          .build();
  return t;
}

const DefTable& cells_table() {
  static const DefTable t =
      TableOf<CellsShape>("elements of any form")
          .vectors("vertices", &CellsShape::vertices, "m", any(), {3, 1'000'000}, "where the corners are")
          .required()
          .integers("cells", &CellsShape::cells, at_least(0), {3, 8'000'000},
                    "corners of every element, one after another, in VTK's order: 3 a triangle, 4 a quad or "
                    "tetrahedron, 8 a hexahedron; nodes between them are added")
          .required()
          .choice("form", &CellsShape::form,
                  {"as_element", "triangles", "quadrangles", "tetrahedra", "hexahedra"},
                  "what the cells are, as mesh files say; where no element is named they are of first order")
          .objects("sets", &CellsShape::sets, set_table(), {0, 10'000},
                   "vertices with a name, as groups of mesh files are; further ones beside the mesh")
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
          .vector("from", &CylinderRegion::from, "m", any(), "middle of one end")
          .vector("to", &CylinderRegion::to, "m", any(), "middle of the other end")
          .number("radius", &CylinderRegion::radius, "m", above(0), "of the cylinder")
          .check([](const CylinderRegion& c, const DefTable::Report& report) {
            if (!(norm2(c.to - c.from) > 0)) report("/to", "a cylinder has a length above 0");
          })
          .build();
  static const DefTable t =
      TableOf<FillShape>(
          "region that is filled with tetrahedra (isosurface stuffing): edges of it that are sharper "
          "than the spacing are rounded off")
          .object("ball", &FillShape::ball, ball, "a ball")
          .object("cylinder", &FillShape::cylinder, cylinder, "a cylinder")
          .object("surface", &FillShape::surface, mesh_shape_table(),
                  "what closed surfaces hold, whose triangles all run the same way round")
          .number("spacing", &FillShape::spacing, "m", above(0), "of the lattice of elements")
          .build();
  return t;
}

const DefTable& copy_table() {
  static const DefTable t =
      TableOf<CopyDef>("a body of this shape, turned about the origin, then moved")
          .vector("position", &CopyDef::position, "m", any(), "by which it is moved")
          .vector("axis", &CopyDef::axis, "1", any(), "it is turned about")
          .number("angle", &CopyDef::angle, "rad", any(), "by which it is turned")
          .vector("velocity", &CopyDef::velocity, "m/s", any(), "initial, added to that of all")
          .check([](const CopyDef& c, const DefTable::Report& report) {
            if (!(norm2(c.axis) > 0)) report("/axis", "an axis has a length above 0");
          })
          .build();
  return t;
}

const DefTable& hold_table() {
  static const DefTable t =
      TableOf<HoldDef>(
          "displacement of a set from where it lies at rest, in m: expressions of t, X, Y, Z (the place at "
          "rest); a component that is absent is free, and where none is given all are held at 0")
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
      TableOf<LoadDef>("what acts on the part of the surface whose nodes are all in a set")
          .text("on", &LoadDef::on, "name of a set")
          .required()
          .vector("force", &LoadDef::force, "N", any(),
                  "in all, spread evenly over the area at rest; keeps its direction")
          .expression("x", &LoadDef::x, "Pa, force along x per area at rest: number or expression of X, Y, Z")
          .expression("y", &LoadDef::y, "Pa, the same along y")
          .expression("z", &LoadDef::z, "Pa, the same along z")
          .number("pressure", &LoadDef::pressure, "Pa", any(),
                  "on the deformed surface and against its normal, wherever that turns")
          .build();
  return t;
}

}  // namespace truestep::fem
