// Shapes as triangles: boxes, capsules, cylinders and plane patches are tessellated as finely as their size
// in the picture requires; solid spheres stay exact. A container is its edges plus a film of glass whose
// triangles are sorted far to near.
#include <algorithm>
#include <cmath>
#include <span>

#include "engine/sinks/picture/geometry.h"
#include "engine/sinks/picture/pose.h"

namespace truestep::picture {
namespace {

constexpr int kAround = 48;  // segments around the axis of a large shape
constexpr double kTurn = 6.28318530717958647692;
constexpr Color kSolid{0.78f, 0.80f, 0.83f}, kEdge{0.42f, 0.46f, 0.52f};

Vec3f narrow(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

using Triangles = std::vector<MeshVertex>;

void add_quad(Triangles& out, const View& view, const Vec3 (&corner)[4], const Vec3 (&normal)[4],
              Bytes4 color) {
  for (int i : {0, 1, 2, 0, 2, 3}) out.push_back({view.units.position(corner[i]), narrow(normal[i]), color});
}

void box_faces(Triangles& out, const View& view, const Pose& pose, const Vec3& h, Bytes4 color) {
  for (int face = 0; face < 6; ++face) {
    const int a = face / 2;
    const double sign = face % 2 ? 1 : -1;
    Vec3 unit[3];  // outward, and two along the face
    for (int i = 0; i < 3; ++i) {
      const int k = (a + i) % 3;
      unit[i] = {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
    }
    const auto scaled = [&](const Vec3& v) { return Vec3{v.x * h.x, v.y * h.y, v.z * h.z}; };
    const Vec3 o = scaled(unit[0]) * sign, s = scaled(unit[1]), t = scaled(unit[2]);
    const Vec3 corner[4] = {pose.point(o - s - t), pose.point(o + s - t), pose.point(o + s + t),
                            pose.point(o - s + t)};
    const Vec3 n = pose.direction(unit[0] * sign), normal[4] = {n, n, n, n};
    add_quad(out, view, corner, normal, color);
  }
}

// Segments around a circle of radius r (m): a multiple of 4 for which the sagitta stays below a fifth of a
// pixel.
int segments(const View& view, const Pose& pose, double r) {
  const Vec3f c = view.units.position(pose.position);
  const double distance = std::max(norm(Vec3{c.x, c.y, c.z} - view.eye), view.near_plane);
  const double pixels = view.units.length(r) / (distance * view.pixel);
  const double n = kTurn / 2 / std::acos(1 - std::min(1.0, 0.2 / std::max(pixels, 0.2)));
  return std::clamp(4 * static_cast<int>(std::ceil(n / 4)), 8, kAround);
}

// A ring of a solid of revolution about y: its position and the normal of the surface.
struct Ring {
  double radius, y, normal_radial, normal_y;
};

// Bands between rings 2 k and 2 k + 1, from low to high.
void turned_faces(Triangles& out, const View& view, const Pose& pose, int around, std::span<const Ring> rings,
                  Bytes4 color) {
  std::vector<Vec3> sides;
  for (int j = 0; j <= around; ++j) {
    const double angle = kTurn * j / around;
    sides.push_back({std::cos(angle), 0, std::sin(angle)});
  }
  for (size_t i = 0; i + 1 < rings.size(); i += 2)
    for (int j = 0; j < around; ++j) {
      Vec3 corner[4], normal[4];
      for (int c = 0; c < 4; ++c) {
        const Ring& ring = rings[i + (c == 1 || c == 2 ? 1 : 0)];
        const Vec3& side = sides[static_cast<size_t>(j + (c >= 2 ? 1 : 0))];
        normal[c] = pose.direction(side * ring.normal_radial + Vec3{0, ring.normal_y, 0});
        corner[c] = pose.point(side * ring.radius + Vec3{0, ring.y, 0});
      }
      add_quad(out, view, corner, normal, color);
    }
}

// A sphere cut at its equator, the halves `half` away from the middle along y, joined by a cylinder.
void capsule_faces(Triangles& out, const View& view, const Pose& pose, double r, double half, Bytes4 color) {
  const int around = segments(view, pose, r), steps = around / 4;
  std::vector<Ring> rings;
  const auto ring = [&](int step, double offset) {
    const double latitude = kTurn / 4 * (static_cast<double>(step) / steps);
    const double c = std::cos(latitude), s = std::sin(latitude);
    rings.push_back({r * c, r * s + offset, c, s});
  };
  for (int i = -steps; i < 0; ++i) ring(i, -half), ring(i + 1, -half);
  if (half > 0) ring(0, -half), ring(0, half);
  for (int i = 0; i < steps; ++i) ring(i, half), ring(i + 1, half);
  turned_faces(out, view, pose, around, rings, color);
}

void cylinder_faces(Triangles& out, const View& view, const Pose& pose, double r, double half, Bytes4 color) {
  const Ring rings[] = {{0, -half, 0, -1}, {r, -half, 0, -1}, {r, -half, 1, 0},
                        {r, half, 1, 0},   {r, half, 0, 1},   {0, half, 0, 1}};
  turned_faces(out, view, pose, segments(view, pose, r), rings, color);
}

// A mesh has its own vertices, shared by its triangles.
void add_mesh(Geometry& g, const View& view, const Pose& pose, const DrawnMesh& mesh, Bytes4 color) {
  const auto first = static_cast<uint32_t>(g.mesh.size());
  for (size_t i = 0; i < mesh.positions.size() / 3; ++i) {
    const Vec3f p = load3(mesh.positions.data(), i), n = load3(mesh.normals.data(), i);
    g.mesh.push_back(
        {view.units.position(pose.point({p.x, p.y, p.z})), narrow(pose.direction({n.x, n.y, n.z})), color});
    g.extent.add(view, g.mesh.back().position, 0);
  }
  for (const uint32_t i : mesh.triangles) g.triangles.push_back(first + i);
}

void circle(Geometry& g, const View& view, const Pose& pose, const Vec3& centre, const Vec3& u, const Vec3& v,
            double r) {
  const auto at = [&](int i) {
    const double angle = kTurn * i / (2 * kAround);
    return view.units.position(pose.point(centre + u * (r * std::cos(angle)) + v * (r * std::sin(angle))));
  };
  for (int i = 0; i < 2 * kAround; ++i) g.add_line(view, at(i), at(i + 1), 0, bytes_of(kEdge));
}

void box_edges(Geometry& g, const View& view, const Pose& pose, const Vec3& h) {
  for (int a = 0; a < 8; ++a)
    for (int bit : {1, 2, 4}) {
      if (a & bit) continue;
      const auto corner = [&](int c) {
        return view.units.position(pose.point({c & 1 ? h.x : -h.x, c & 2 ? h.y : -h.y, c & 4 ? h.z : -h.z}));
      };
      g.add_line(view, corner(a), corner(a | bit), 0, bytes_of(kEdge));
    }
}

void round_edges(Geometry& g, const View& view, const Pose& pose, double r, double half) {
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  circle(g, view, pose, y * half, x, z, r);
  if (half <= 0) return circle(g, view, pose, {}, x, y, r), circle(g, view, pose, {}, z, y, r);
  circle(g, view, pose, y * -half, x, z, r);
  for (const Vec3& side : {x, -x, z, -z})
    g.add_line(view, view.units.position(pose.point(side * r - y * half)),
               view.units.position(pose.point(side * r + y * half)), 0, bytes_of(kEdge));
}

// A square of the plane around the foot of the target; opaque from its free side, glass from behind.
void plane_patch(Geometry& g, Triangles& out, const View& view, const DrawShape& s, Bytes4 color) {
  const Vec3 n = normalized(s.size, {0, 1, 0});
  const Vec3 u = normalized(cross(std::abs(dot(n, view.axes.up)) < 0.99 ? view.axes.up : view.axes.side, n));
  const Vec3 v = cross(n, u);
  const Vec3 foot = view.units.origin - n * dot(view.units.origin - s.position, n);
  const double half = 1.1 * std::max(g.extent.radius, 0.1) / view.units.scale;
  const Vec3 corner[4] = {foot - u * half - v * half, foot + u * half - v * half, foot + u * half + v * half,
                          foot - u * half + v * half};
  const Vec3 normal[4] = {n, n, n, n};
  add_quad(out, view, corner, normal, color);
  for (int i = 0; i < 4; ++i)
    g.lines.insert(
        g.lines.end(), 4,
        {view.units.position(corner[i]), view.units.position(corner[(i + 1) % 4]), 0, bytes_of(kEdge)});
}

}  // namespace

void add_shape(Geometry& g, const View& view, const DrawShape& s) {
  const Pose pose(s);
  const Bytes4 color = bytes_of(s.color.value_or(kSolid));
  const double sum = s.position.x + s.position.y + s.position.z + s.size.x + s.size.y + s.size.z;
  if (!std::isfinite(sum)) return;
  Triangles faces;
  if (s.kind == DrawShape::Kind::mesh && !s.mesh) return;
  switch (s.kind) {
    case DrawShape::Kind::sphere:
      if (!s.container)
        return g.add_sphere(view, view.units.position(s.position), view.units.length(s.size.x), color);
      capsule_faces(faces, view, pose, s.size.x, 0, color);
      round_edges(g, view, pose, s.size.x, 0);
      break;
    case DrawShape::Kind::capsule:
      capsule_faces(faces, view, pose, s.size.x, s.size.y, color);
      if (s.container) round_edges(g, view, pose, s.size.x, s.size.y);
      break;
    case DrawShape::Kind::cylinder:
      cylinder_faces(faces, view, pose, s.size.x, s.size.y, color);
      if (s.container) round_edges(g, view, pose, s.size.x, s.size.y);
      break;
    case DrawShape::Kind::mesh:
      if (!s.container) return add_mesh(g, view, pose, *s.mesh, color);
      for (const uint32_t i : s.mesh->triangles) {
        const Vec3f p = load3(s.mesh->positions.data(), i), n = load3(s.mesh->normals.data(), i);
        faces.push_back({view.units.position(pose.point({p.x, p.y, p.z})),
                         narrow(pose.direction({n.x, n.y, n.z})), color});
      }
      break;
    case DrawShape::Kind::box:
      box_faces(faces, view, pose, s.size, color);
      if (s.container) box_edges(g, view, pose, s.size);
      break;
    case DrawShape::Kind::plane:
      plane_patch(g, faces, view, s, color);
      break;
  }
  const bool behind = s.kind == DrawShape::Kind::plane && dot(view.camera.eye - s.position, s.size) < 0;
  if (s.container || behind) {
    g.glass.insert(g.glass.end(), faces.begin(), faces.end());
    sort_far_to_near(g.glass, view);
    return;
  }
  for (const MeshVertex& v : faces) {
    g.triangles.push_back(static_cast<uint32_t>(g.mesh.size()));
    g.mesh.push_back(v);
    if (s.kind != DrawShape::Kind::plane) g.extent.add(view, v.position, 0);
  }
}

}  // namespace truestep::picture
