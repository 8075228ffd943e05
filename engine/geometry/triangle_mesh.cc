#include "engine/geometry/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/errors.h"

namespace truestep {

bool MeshTriangle::complete() {
  const Vec3 u = corner[1] - corner[0], v = corner[2] - corner[0], n = cross(u, v);
  const double longest = std::max({norm2(u), norm2(v), norm2(v - u)});
  if (!(norm(n) > 1e-12 * longest)) return false;
  normal = normalized(n);
  for (size_t k = 0; k < 3; ++k) {
    inward[k] = normalized(cross(normal, corner[(k + 1) % 3] - corner[k]));
  }
  return true;
}

void MeshTriangle::set_neighbor(size_t k, uint32_t index, const Vec3& third) {
  neighbor[k] = index;
  const Vec3 edge = normalized(corner[(k + 1) % 3] - corner[k]), to = third - corner[k];
  beyond[k] = normalized(to - edge * dot(to, edge));
}

bool MeshTriangle::allows(const Vec3& d) const {
  // A hundredth of a degree: rounding may tilt a body resting on flat ground by this much.
  constexpr double kLean = 2e-4;
  if (dot(d, normal) <= 0) return false;
  for (size_t k = 0; k < 3; ++k) {
    if (neighbor[k] != kBorder && dot(d, inward[k]) < -kLean && dot(d, beyond[k]) > kLean) return false;
  }
  return true;
}

namespace {

struct Side {
  uint32_t triangle, edge;
};
using OpenSides = std::map<std::array<uint32_t, 2>, Side>;

/// Files repeat corners at seams of their textures: sides that nothing continues and that run between the
/// same places in opposite directions belong together.
void join_seams(const OpenSides& open, std::vector<MeshTriangle>& triangles) {
  std::map<std::array<double, 6>, Side> at;
  for (const auto& [ids, side] : open) {
    const MeshTriangle& t = triangles[side.triangle];
    const Vec3 &a = t.corner[side.edge], &b = t.corner[(side.edge + 1) % 3];
    const auto other = at.find({b.x, b.y, b.z, a.x, a.y, a.z});
    if (other == at.end()) {
      at[{a.x, a.y, a.z, b.x, b.y, b.z}] = side;
      continue;
    }
    const Side s = other->second;
    triangles[side.triangle].set_neighbor(side.edge, s.triangle,
                                          triangles[s.triangle].corner[(s.edge + 2) % 3]);
    triangles[s.triangle].set_neighbor(s.edge, side.triangle, t.corner[(side.edge + 2) % 3]);
    at.erase(other);
  }
}

}  // namespace

TriangleMesh::TriangleMesh(std::vector<Vec3> vertices, std::vector<uint32_t> triangles) {
  for (const Vec3& v : vertices) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) {
      throw Error("bad_solid", "the vertices of a mesh must be finite");
    }
  }
  if (triangles.size() % 3 != 0)
    throw Error("bad_solid", "the triangles of a mesh must be triples of indices");
  OpenSides open;
  std::vector<std::array<uint32_t, 3>> ids;
  for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
    MeshTriangle m;
    std::array<uint32_t, 3> id;
    for (size_t k = 0; k < 3; ++k) {
      id[k] = triangles[t + k];
      if (id[k] >= vertices.size())
        throw Error("bad_solid", "a triangle of the mesh refers to a vertex that does not exist");
      m.corner[k] = vertices[id[k]], m.vertex[k] = id[k];
    }
    if (!m.complete()) continue;
    const auto index = static_cast<uint32_t>(triangles_.size());
    triangles_.push_back(m);
    ids.push_back(id);
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t from = id[k], to = id[(k + 1) % 3];
      const auto other = open.find({to, from});
      if (other == open.end()) {
        open[{from, to}] = {index, k};
        continue;
      }
      const Side s = other->second;
      triangles_[index].set_neighbor(k, s.triangle, vertices[ids[s.triangle][(s.edge + 2) % 3]]);
      triangles_[s.triangle].set_neighbor(s.edge, index, vertices[id[(k + 2) % 3]]);
      open.erase(other);
    }
  }
  if (triangles_.empty()) throw Error("bad_solid", "a mesh needs at least one triangle with an area");
  join_seams(open, triangles_);
  std::vector<Box> boxes;
  for (const MeshTriangle& t : triangles_) {
    Box b = Box::nothing();
    for (const Vec3& c : t.corner) b.cover(c);
    boxes.push_back(b);
  }
  tree_.build(boxes);
}

bool TriangleMesh::closed() const {
  return std::all_of(triangles_.begin(), triangles_.end(), [](const MeshTriangle& t) {
    return std::find(t.neighbor.begin(), t.neighbor.end(), MeshTriangle::kBorder) == t.neighbor.end();
  });
}

}  // namespace truestep
