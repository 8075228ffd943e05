// View of a box, hull or triangle as vertices, faces and edges in its own frame, for separating axes and
// clipping. A triangle has one face; the normals on the far side of its edges are chosen so that an edge
// covers every direction around it.
#pragma once
#include "engine/collision/pairs/convex.h"
#include "engine/collision/pairs/face_clip.h"

namespace truestep {

struct Polyhedron {
  const Vec3* vertices = nullptr;
  const HullFace* faces = nullptr;
  const uint32_t* loops = nullptr;
  const HullEdge* edges = nullptr;
  int vertex_count = 0, face_count = 0, edge_count = 0;
  Vec3 center;
  double thickness = 0;  ///< m, from the centre to the nearest face; infinite for a triangle
  const MeshTriangle* triangle = nullptr;
};

/// Storage for data that boxes and triangles lack.
struct PolyhedronStorage {
  Vec3 vertices[8];
  HullFace faces[6];
  HullEdge edges[3];
};

/// `c` must be a box, hull or triangle; it and `storage` must outlive the view.
Polyhedron polyhedron(const Convex& c, PolyhedronStorage& storage);

/// Corners of a face transformed by `at`; large numbers are thinned out evenly.
void face_polygon(const Polyhedron& p, int face, const Transform& at, FacePolygon& out);
/// The face whose normal is closest to the unit vector d.
int face_towards(const Polyhedron& p, const Vec3& d);
/// The best such face among those containing the furthest vertex along d: on sharp solids another face may be
/// closer to d and not reach there.
int furthest_face(const Polyhedron& p, const Vec3& d);

}  // namespace truestep
