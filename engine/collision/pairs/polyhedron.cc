#include "engine/collision/pairs/polyhedron.h"

#include <algorithm>

namespace truestep {
namespace {

/// The cube with vertices at (+-1, +-1, +-1): bit k of a vertex is the side along axis k; faces +x -x +y -y
/// +z -z.
const Hull& cube() {
  static const Hull hull = [] {
    Hull h;
    for (int i = 0; i < 8; ++i)
      h.vertices.push_back({i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
    h.loops = {1, 3, 7, 5, 0, 4, 6, 2, 2, 6, 7, 3, 0, 1, 5, 4, 4, 5, 7, 6, 0, 2, 3, 1};
    for (uint32_t f = 0; f < 6; ++f) h.faces.push_back({{}, 0, 4 * f, 4});
    complete_hull(h);
    return h;
  }();
  return hull;
}

constexpr uint32_t kTriangleLoop[3] = {0, 1, 2};

Polyhedron of_box(const Vec3& half, PolyhedronStorage& s) {
  const Hull& h = cube();
  for (size_t i = 0; i < 8; ++i) {
    const Vec3& c = h.vertices[i];
    s.vertices[i] = {c.x * half.x, c.y * half.y, c.z * half.z};
  }
  const double e[3] = {half.x, half.y, half.z};
  for (size_t f = 0; f < 6; ++f) {
    s.faces[f] = h.faces[f];
    s.faces[f].offset = e[f / 2];
  }
  return {s.vertices,
          s.faces,
          h.loops.data(),
          h.edges.data(),
          8,
          6,
          static_cast<int>(h.edges.size()),
          {},
          std::min(half.x, std::min(half.y, half.z))};
}

Polyhedron of_triangle(const MeshTriangle& t, PolyhedronStorage& s) {
  s.faces[0] = {t.normal, dot(t.normal, t.corner[0]), 0, 3};
  for (uint32_t k = 0; k < 3; ++k) {
    s.vertices[k] = t.corner[k];
    const uint32_t next = (k + 1) % 3;
    // An edge's directions are almost all around it; MeshTriangle::allows decides which of them may push.
    const Vec3 far = normalized(-t.normal - t.inward[k] * 1e-2);
    s.faces[1 + k] = {far, 0, 0, 0};
    s.edges[k] = {k, next, 0, 1 + k};
  }
  const Vec3 center = (t.corner[0] + t.corner[1] + t.corner[2]) / 3.0;
  return {
      s.vertices, s.faces, kTriangleLoop, s.edges, 3, 1, 3, center, std::numeric_limits<double>::infinity(),
      &t};
}

}  // namespace

Polyhedron polyhedron(const Convex& c, PolyhedronStorage& storage) {
  if (c.kind == SolidKind::box) return of_box(c.size, storage);
  if (c.kind == SolidKind::triangle) return of_triangle(*c.triangle, storage);
  const Hull& h = *c.hull;
  return {h.vertices.data(),
          h.faces.data(),
          h.loops.data(),
          h.edges.data(),
          static_cast<int>(h.vertices.size()),
          static_cast<int>(h.faces.size()),
          static_cast<int>(h.edges.size()),
          h.center,
          h.thickness};
}

void face_polygon(const Polyhedron& p, int face, const Transform& at, FacePolygon& out) {
  constexpr uint32_t kFull = 32;
  const HullFace& f = p.faces[face];
  out.count = 0;
  const uint32_t n = f.count <= kFull ? f.count : kFull;
  for (uint32_t k = 0; k < n; ++k) {
    const uint32_t v =
        p.loops[f.first + (n == f.count ? k : static_cast<uint32_t>(uint64_t{k} * f.count / n))];
    out.add(at.point(p.vertices[v]), v & 0x3ff);
  }
}

int face_towards(const Polyhedron& p, const Vec3& d) {
  int best = 0;
  double most = dot(p.faces[0].normal, d);
  for (int f = 1; f < p.face_count; ++f) {
    if (const double c = dot(p.faces[f].normal, d); c > most) most = c, best = f;
  }
  return best;
}

int furthest_face(const Polyhedron& p, const Vec3& d) {
  uint32_t vertex = 0;
  double far = dot(p.vertices[0], d);
  for (int i = 1; i < p.vertex_count; ++i) {
    if (const double s = dot(p.vertices[i], d); s > far) far = s, vertex = static_cast<uint32_t>(i);
  }
  int best = -1;
  double most = -2;
  for (int f = 0; f < p.face_count; ++f) {
    const HullFace& face = p.faces[f];
    const double c = dot(face.normal, d);
    if (!(c > most)) continue;
    for (uint32_t k = 0; k < face.count; ++k) {
      if (p.loops[face.first + k] != vertex) continue;
      most = c, best = f;
      break;
    }
  }
  return best < 0 ? 0 : best;
}

}  // namespace truestep
