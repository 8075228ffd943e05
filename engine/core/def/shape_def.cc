#include "engine/core/def/shape_def.h"

namespace truestep {

const DefTable& rope_shape_table() {
  static const DefTable t =
      TableOf<RopeShape>("chain of points from one place to another")
          .vector("from", &RopeShape::from, "m", any(), "where the first point is")
          .required()
          .vector("to", &RopeShape::to, "m", any(), "where the last point is")
          .required()
          .integer("links", &RopeShape::links, between(1, 1e6), "springs between the two ends")
          .number("length", &RopeShape::length, "m", above(0),
                  "length at rest; longer than the distance: the rope begins with a sag")
          .build();
  return t;
}

const DefTable& hair_shape_table() {
  static const DefTable t =
      TableOf<HairShape>("strands with their roots spread over a disc")
          .vector("root", &HairShape::root, "m", any(), "centre of the disc")
          .number("radius", &HairShape::radius, "m", at_least(0), "of the disc")
          .integer("strands", &HairShape::strands, between(1, 1e5), "number of strands")
          .integer("links", &HairShape::links, between(2, 1000), "springs per strand")
          .number("length", &HairShape::length, "m", above(0), "of a strand")
          .vector("direction", &HairShape::direction, "1", any(), "direction in which the strands grow")
          .check([](const HairShape& h, const DefTable::Report& report) {
            if (!(norm2(h.direction) > 0)) report("/direction", "the direction must not be zero");
          })
          .build();
  return t;
}

const DefTable& helix_shape_table() {
  static const DefTable t =
      TableOf<HelixShape>("chain of points on a helix; with pitch 0 an arc or a ring")
          .vector("centre", &HelixShape::centre, "m", any(), "point of the axis, level with the first point")
          .vector("axis", &HelixShape::axis, "1", any(), "direction in which it rises")
          .vector("start", &HelixShape::start, "1", any(), "from the centre towards the first point")
          .number("radius", &HelixShape::radius, "m", above(0), "of the points")
          .number("pitch", &HelixShape::pitch, "m", any(), "rise in a whole turn; negative: left-handed")
          .number("turns", &HelixShape::turns, "1", above(0), "from the first to the last point")
          .integer("links", &HelixShape::links, between(1, 1e6), "springs between the two ends")
          .check([](const HelixShape& h, const DefTable::Report& report) {
            if (!(norm2(h.axis) > 0)) return report("/axis", "the direction must not be zero");
            if (!(norm(cross(h.axis, h.start)) > 1e-9 * norm(h.axis) * norm(h.start))) {
              report("/start", "must have a component perpendicular to the axis");
            }
            if (h.turns > h.links / 3.0) {
              report("/turns",
                     "needs at least three links per turn, but " + std::to_string(h.links) + " are given");
            }
          })
          .build();
  return t;
}

const DefTable& cloth_grid_shape_table() {
  static const DefTable t =
      TableOf<ClothGridShape>("rectangular cloth; point (i, j) has index j nx + i")
          .vector("origin", &ClothGridShape::origin, "m", any(), "corner (0, 0)")
          .vector("edge_u", &ClothGridShape::edge_u, "m", any(), "from corner (0, 0) to the end of u")
          .vector("edge_v", &ClothGridShape::edge_v, "m", any(), "from corner (0, 0) to the end of v")
          .integer("nx", &ClothGridShape::nx, between(2, 10000), "points along u")
          .integer("ny", &ClothGridShape::ny, between(2, 10000), "points along v")
          .choice("shear", &ClothGridShape::shear, {"both", "one", "none"},
                  "diagonal springs per square: both, one or none")
          .check([](const ClothGridShape& g, const DefTable::Report& report) {
            if (!(norm2(cross(g.edge_u, g.edge_v)) > 0)) report("", "edge_u and edge_v must span an area");
          })
          .build();
  return t;
}

const DefTable& mesh_shape_table() {
  static const DefTable t =
      TableOf<MeshShape>("triangle mesh: a spring along every edge, a bending spring across it")
          .vectors("vertices", &MeshShape::vertices, "m", any(), {3, 1'000'000}, "positions of the points")
          .required()
          .integers("triangles", &MeshShape::triangles, at_least(0), {3, 6'000'000},
                    "three vertex indices per triangle, one after another")
          .required()
          .check([](const MeshShape& m, const DefTable::Report& report) {
            if (m.triangles.size() % 3) report("/triangles", "the length must be a multiple of three");
            const auto n = static_cast<int64_t>(m.vertices.size());
            for (size_t i = 0; i < m.triangles.size(); ++i) {
              if (m.triangles[i] < n) continue;
              return report("/triangles/" + std::to_string(i), "there is no such vertex");
            }
            for (size_t t = 0; t + 2 < m.triangles.size(); t += 3) {
              const int64_t a = m.triangles[t], b = m.triangles[t + 1], c = m.triangles[t + 2];
              if (a == b || b == c || c == a) {
                return report("/triangles/" + std::to_string(t), "a triangle needs three different vertices");
              }
            }
          })
          .build();
  return t;
}

const DefTable& soft_block_shape_table() {
  static const DefTable t =
      TableOf<SoftBlockShape>("box of tetrahedra, five per cell")
          .vector("origin", &SoftBlockShape::origin, "m", any(), "corner with the smallest coordinates")
          .vector("size", &SoftBlockShape::size, "m", above(0), "lengths of the edges")
          .integer("cells_x", &SoftBlockShape::cells_x, between(1, 200), "cells along x")
          .integer("cells_y", &SoftBlockShape::cells_y, between(1, 200), "cells along y")
          .integer("cells_z", &SoftBlockShape::cells_z, between(1, 200), "cells along z")
          .build();
  return t;
}

}  // namespace truestep
