#include "engine/collision/drawn_mesh.h"

#include <cmath>
#include <map>

#include "engine/geometry/height_field.h"
#include "engine/geometry/triangle_mesh.h"

namespace truestep {
namespace {

constexpr double kCrease = 0.8;     // cosine of 37 degrees
constexpr size_t kMostCells = 512;  // per side of a height field

using Triangle = std::array<uint32_t, 3>;

/// Triangles around every point: those of point i are items[first[i]] to items[first[i + 1]].
struct Around {
  std::vector<uint32_t> first, items;
  Around(size_t points, std::span<const Triangle> triangles)
      : first(points + 1), items(3 * triangles.size()) {
    for (const Triangle& t : triangles) {
      for (const uint32_t i : t) ++first[i + 1];
    }
    for (size_t i = 0; i < points; ++i) first[i + 1] += first[i];
    std::vector<uint32_t> next(first.begin(), first.end() - 1);
    for (uint32_t t = 0; t < triangles.size(); ++t) {
      for (const uint32_t i : triangles[t]) items[next[i]++] = t;
    }
  }
};

void append(std::vector<float>& out, const Vec3& v) {
  out.insert(out.end(), {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
}

std::shared_ptr<const DrawnMesh> hull_mesh(const Hull& hull) {
  std::vector<Triangle> triangles;
  for (const HullFace& f : hull.faces) {
    const uint32_t* loop = &hull.loops[f.first];
    for (uint32_t k = 1; k + 1 < f.count; ++k) triangles.push_back({loop[0], loop[k], loop[k + 1]});
  }
  return creased_mesh(hull.vertices, triangles);
}

/// Merges corners at the same position.
std::shared_ptr<const DrawnMesh> surface_mesh(const TriangleMesh& mesh) {
  std::map<std::array<double, 3>, uint32_t> known;
  std::vector<Vec3> points;
  std::vector<Triangle> triangles(mesh.size());
  for (uint32_t t = 0; t < mesh.size(); ++t) {
    for (size_t k = 0; k < 3; ++k) {
      const Vec3& p = mesh.triangle(t).corner[k];
      const auto [at, fresh] = known.try_emplace({p.x, p.y, p.z}, static_cast<uint32_t>(points.size()));
      if (fresh) points.push_back(p);
      triangles[t][k] = at->second;
    }
  }
  return creased_mesh(points, triangles);
}

std::shared_ptr<const DrawnMesh> field_mesh(const HeightField& field) {
  const size_t stride = (std::max(field.columns(), field.lines()) - 2) / kMostCells + 1;
  const auto picks = [stride](size_t n) {
    std::vector<size_t> at;
    for (size_t i = 0; i + 1 < n; i += stride) at.push_back(i);
    at.push_back(n - 1);
    return at;
  };
  const std::vector<size_t> is = picks(field.columns()), js = picks(field.lines());
  std::vector<Vec3> points;
  for (const size_t j : js) {
    for (const size_t i : is) points.push_back(field.vertex(i, j));
  }
  std::vector<Triangle> triangles;
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    if (std::isfinite(points[a].y + points[b].y + points[c].y)) triangles.push_back({a, b, c});
  };
  const auto n = static_cast<uint32_t>(is.size());
  for (uint32_t j = 0; j + 1 < js.size(); ++j) {
    for (uint32_t i = 0; i + 1 < n; ++i) {
      const uint32_t a = j * n + i;  // cut from (i, j + 1) to (i + 1, j), like the collision surface
      add(a, a + n, a + 1);
      add(a + 1, a + n, a + n + 1);
    }
  }
  return creased_mesh(points, triangles);
}

}  // namespace

std::shared_ptr<const DrawnMesh> creased_mesh(std::span<const Vec3> points,
                                              std::span<const Triangle> triangles) {
  std::vector<Vec3> area(triangles.size()), unit(triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    area[t] = cross(points[b] - points[a], points[c] - points[a]);
    unit[t] = normalized(area[t], {});
  }
  const Around around(points.size(), triangles);
  auto mesh = std::make_shared<DrawnMesh>();
  // A point appears once for each normal that it needs.
  struct Corner {
    Vec3 normal;
    uint32_t index = 0;
  };
  std::vector<std::vector<Corner>> corners(points.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    if (unit[t] == Vec3{}) continue;
    for (const uint32_t p : triangles[t]) {
      Vec3 sum;
      for (uint32_t k = around.first[p]; k < around.first[p + 1]; ++k) {
        const uint32_t other = around.items[k];
        if (dot(unit[other], unit[t]) > kCrease) sum += area[other];
      }
      const Vec3 normal = normalized(sum, unit[t]);
      uint32_t index = ~0u;
      for (const Corner& c : corners[p]) {
        if (norm2(c.normal - normal) < 1e-12) index = c.index;
      }
      if (index == ~0u) {
        index = static_cast<uint32_t>(mesh->positions.size() / 3);
        corners[p].push_back({normal, index});
        append(mesh->positions, points[p]);
        append(mesh->normals, normal);
      }
      mesh->triangles.push_back(index);
    }
  }
  return mesh;
}

std::shared_ptr<const DrawnMesh> drawn_mesh(const Solid& solid) {
  switch (solid.kind) {
    case SolidKind::hull:
      return hull_mesh(*solid.hull);
    case SolidKind::mesh:
      return surface_mesh(*solid.mesh);
    case SolidKind::height_field:
      return field_mesh(*solid.heights);
    default:
      return nullptr;
  }
}

DrawnShape drawn_shape(const Solid& solid, const Pose& at) {
  using Kind = DrawnShape::Kind;
  DrawnShape s;
  const Quat& q = at.orientation;
  s.position = at.position, s.orientation = {q.w, q.x, q.y, q.z}, s.size = solid.size;
  s.mesh = drawn_mesh(solid);
  s.kind = s.mesh                              ? Kind::mesh
           : solid.kind == SolidKind::box      ? Kind::box
           : solid.kind == SolidKind::capsule  ? Kind::capsule
           : solid.kind == SolidKind::cylinder ? Kind::cylinder
           : solid.kind == SolidKind::plane    ? Kind::plane
                                               : Kind::sphere;
  return s;
}

}  // namespace truestep
