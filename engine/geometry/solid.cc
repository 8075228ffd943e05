#include "engine/geometry/solid.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/geometry/compound.h"
#include "engine/geometry/height_field.h"
#include "engine/geometry/triangle_mesh.h"

namespace truestep {
namespace {

constexpr double kHuge = std::numeric_limits<double>::infinity();

double positive(double size, const char* what) {
  if (!(size > 0) || !std::isfinite(size)) {
    throw Error("bad_solid", std::string(what) + " must be positive and finite");
  }
  return size;
}

/// Box around a rotated and moved box.
Box moved_box(const Box& b, const Transform& at) {
  const Vec3 h = (b.high - b.low) * 0.5, c = at.point(b.center());
  const auto reach = [&](const Vec3& row) {
    return std::fabs(row.x) * h.x + std::fabs(row.y) * h.y + std::fabs(row.z) * h.z;
  };
  const Vec3 e{reach(at.rotation.row[0]), reach(at.rotation.row[1]), reach(at.rotation.row[2])};
  return {c - e, c + e};
}

Box around(const Vec3& center, const Vec3& half) {
  return {center - half, center + half};
}

double farthest(const Box& b) {
  const auto f = [](double l, double h) { return std::max(std::fabs(l), std::fabs(h)); };
  return norm(Vec3{f(b.low.x, b.high.x), f(b.low.y, b.high.y), f(b.low.z, b.high.z)});
}

}  // namespace

Solid sphere_solid(double radius) {
  return {SolidKind::sphere, {positive(radius, "a sphere's radius"), 0, 0}};
}
Solid capsule_solid(double radius, double half_length) {
  return {SolidKind::capsule,
          {positive(radius, "a capsule's radius"), positive(half_length, "a capsule's length"), 0}};
}
Solid cylinder_solid(double radius, double half_length) {
  return {SolidKind::cylinder,
          {positive(radius, "a cylinder's radius"), positive(half_length, "a cylinder's length"), 0}};
}
Solid box_solid(const Vec3& half_extents) {
  for (const double s : {half_extents.x, half_extents.y, half_extents.z}) positive(s, "a box's half extents");
  return {SolidKind::box, half_extents};
}
Solid plane_solid(const Vec3& normal) {
  positive(norm(normal), "the length of a plane's normal");
  return {SolidKind::plane, normalized(normal)};
}
Solid hull_solid(std::span<const Vec3> points) {
  Solid s{SolidKind::hull};
  s.hull = std::make_shared<const Hull>(convex_hull(points));
  return s;
}
Solid mesh_solid(std::vector<Vec3> vertices, std::vector<uint32_t> triangles) {
  Solid s{SolidKind::mesh};
  s.mesh = std::make_shared<const TriangleMesh>(std::move(vertices), std::move(triangles));
  return s;
}
Solid height_field_solid(size_t nx, size_t nz, double spacing, std::vector<double> heights) {
  Solid s{SolidKind::height_field};
  s.heights = std::make_shared<const HeightField>(nx, nz, spacing, std::move(heights));
  return s;
}
Solid compound_solid(std::vector<SolidPart> parts) {
  Solid s{SolidKind::compound};
  s.compound = std::make_shared<const Compound>(parts);
  return s;
}

Box bounds(const Solid& s, const Transform& at) {
  switch (s.kind) {
    case SolidKind::sphere:
      return around(at.position, {s.size.x, s.size.x, s.size.x});
    case SolidKind::box:
      return moved_box({-s.size, s.size}, at);
    case SolidKind::capsule: {
      const Vec3 a = axis(at.rotation, 1) * s.size.y;
      const double r = s.size.x;
      return around(at.position, {std::fabs(a.x) + r, std::fabs(a.y) + r, std::fabs(a.z) + r});
    }
    case SolidKind::cylinder: {
      // A disc with the unit normal a reaches r sqrt(1 - a_x^2) along x.
      const Vec3 a = axis(at.rotation, 1);
      const auto reach = [&](double c) {
        return std::fabs(c) * s.size.y + s.size.x * std::sqrt(std::max(0.0, 1 - c * c));
      };
      return around(at.position, {reach(a.x), reach(a.y), reach(a.z)});
    }
    case SolidKind::hull: {
      Box b = Box::nothing();
      for (const Vec3& v : s.hull->vertices) b.cover(at.point(v));
      return b;
    }
    case SolidKind::mesh:
      return moved_box(s.mesh->tree().bounds(), at);
    case SolidKind::height_field:
      return moved_box(s.heights->bounds(), at);
    case SolidKind::compound:
      return moved_box(s.compound->tree().bounds(), at);
    case SolidKind::triangle:
    case SolidKind::plane:
      break;
  }
  return {{-kHuge, -kHuge, -kHuge}, {kHuge, kHuge, kHuge}};
}

double bounding_radius(const Solid& s) {
  switch (s.kind) {
    case SolidKind::sphere:
      return s.size.x;
    case SolidKind::box:
      return norm(s.size);
    case SolidKind::capsule:
      return s.size.x + s.size.y;
    case SolidKind::cylinder:
      return std::sqrt(s.size.x * s.size.x + s.size.y * s.size.y);
    case SolidKind::hull:
      return s.hull->radius;
    case SolidKind::mesh:
      return farthest(s.mesh->tree().bounds());
    case SolidKind::height_field:
      return farthest(s.heights->bounds());
    case SolidKind::compound:
      return farthest(s.compound->tree().bounds());
    case SolidKind::triangle:
    case SolidKind::plane:
      break;
  }
  return kHuge;
}

double inner_radius(const Solid& s) {
  switch (s.kind) {
    case SolidKind::sphere:
    case SolidKind::capsule:
      return s.size.x;
    case SolidKind::box:
      return std::min({s.size.x, s.size.y, s.size.z});
    case SolidKind::cylinder:
      return std::min(s.size.x, s.size.y);
    case SolidKind::hull:
      return s.hull->thickness;
    case SolidKind::compound: {
      double r = kHuge;
      for (const auto& p : s.compound->parts()) r = std::min(r, inner_radius(p.solid));
      return r;
    }
    case SolidKind::plane:
      return kHuge;
    case SolidKind::triangle:
    case SolidKind::mesh:
    case SolidKind::height_field:
      break;
  }
  return 0;
}

}  // namespace truestep
