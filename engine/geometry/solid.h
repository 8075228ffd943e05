// Shapes of rigid bodies in their own frames, as plain values: copies share hulls, meshes, height fields and
// compounds, which are immutable. Axes of capsules and cylinders are y; a height field rises along y.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/hull.h"
#include "engine/geometry/transform.h"

namespace truestep {

class TriangleMesh;
class HeightField;
class Compound;

/// The first six are convex and bounded; `triangle` is one of a mesh.
enum class SolidKind : uint8_t {
  sphere,
  capsule,
  box,
  cylinder,
  hull,
  triangle,
  plane,
  mesh,
  height_field,
  compound
};

struct Solid {
  SolidKind kind = SolidKind::sphere;
  /// m. Sphere: (radius, -, -). Capsule, cylinder: (radius, half length, -), the capsule's ends come on top.
  /// Box: half extents. Plane: unit normal of the half space below it, through the origin.
  Vec3 size{1, 0, 0};
  std::shared_ptr<const Hull> hull = {};
  std::shared_ptr<const TriangleMesh> mesh = {};
  std::shared_ptr<const HeightField> heights = {};
  std::shared_ptr<const Compound> compound = {};
};

/// All throw Error "bad_solid" when a size is not finite or not positive.
Solid sphere_solid(double radius);
Solid capsule_solid(double radius, double half_length);
Solid cylinder_solid(double radius, double half_length);
Solid box_solid(const Vec3& half_extents);
/// Half space; the normal may have any length but zero.
Solid plane_solid(const Vec3& normal);
/// Convex hull of points (see convex_hull for what it refuses).
Solid hull_solid(std::span<const Vec3> points);
/// Triangles as triples of indices, seen from where they run anticlockwise (see TriangleMesh).
Solid mesh_solid(std::vector<Vec3> vertices, std::vector<uint32_t> triangles);
/// Heights at (i, j) of an nx x nz grid of the given spacing, centred on the origin (see HeightField).
Solid height_field_solid(size_t nx, size_t nz, double spacing, std::vector<double> heights);
/// Convex parts with their poses (see Compound).
struct SolidPart {
  Solid solid;
  Pose pose;
};
Solid compound_solid(std::vector<SolidPart> parts);

inline bool is_convex(SolidKind kind) {
  return kind <= SolidKind::triangle;
}
/// A convex set, bounded or not: two of these touch in one place.
inline bool is_convex_or_plane(SolidKind kind) {
  return is_convex(kind) || kind == SolidKind::plane;
}
/// Box around a placed solid; infinite for a plane. Tight except for rotated meshes, height fields,
/// compounds.
Box bounds(const Solid& solid, const Transform& at);
/// Radius (m) of the enclosing ball about the body's origin; infinity for a plane.
double bounding_radius(const Solid& solid);
/// Roughly half the smallest thickness (m): bodies that move farther than this in a step need a sweep test
/// (time_of_impact.h). Zero for surfaces, infinity for a plane.
double inner_radius(const Solid& solid);

}  // namespace truestep
