#include "engine/collision/pairs/seam.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/collision/pairs/polyhedron.h"
#include "engine/collision/point_distance.h"
#include "engine/geometry/compound.h"
#include "engine/geometry/height_field.h"

namespace truestep {
namespace {

/// Cosine to a face's normal above which a contact belongs to that face.
constexpr double kOnFace = 1 - 1e-4;

/// The convex piece of a solid that was touched.
struct Piece {
  Convex shape;
  Transform at;
  std::optional<MeshTriangle> triangle;

  explicit Piece(const Touched& t) : at(t.at) {
    switch (t.solid.kind) {
      case SolidKind::mesh:
        triangle = t.solid.mesh->triangle(t.part);
        break;
      case SolidKind::height_field:
        triangle = t.solid.heights->triangle(t.part);
        break;
      case SolidKind::compound: {
        const Compound::Part& p = t.solid.compound->parts()[t.part];
        shape = view(p.solid), at = t.at * p.place;
        return;
      }
      default:
        shape = view(t.solid);
        return;
    }
    if (triangle) shape = view(*triangle);
  }
  Piece(const Piece&) = delete;
  Piece& operator=(const Piece&) = delete;
};

bool on_face(const Piece& p, const Vec3& normal) {
  const Vec3 n = p.at.inverse_direction(normal);
  switch (p.shape.kind) {
    case SolidKind::plane:
      return true;
    case SolidKind::box:
      return std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) > kOnFace;
    case SolidKind::triangle:
      return dot(p.triangle->normal, n) > kOnFace;
    case SolidKind::hull: {
      PolyhedronStorage storage;
      const Polyhedron faces = polyhedron(p.shape, storage);
      return dot(faces.faces[face_towards(faces, n)].normal, n) > kOnFace;
    }
    default:
      return false;
  }
}

/// m by which the piece rises above the plane through `from` with this normal.
double rises(const Piece& p, const Vec3& up, const Vec3& from) {
  const Vec3 top = p.at.point(p.shape.support(p.at.inverse_direction(up)));
  return dot(up, top - from) + p.shape.radius();
}

}  // namespace

bool is_seam(const Touched& beside, const Touched& ground, double flush, double deep) {
  if (beside.solid.kind == SolidKind::plane || dot(beside.normal, ground.normal) > kOnFace) return false;
  const Vec3& up = ground.normal;
  const double height = dot(up, beside.point - ground.point);
  if (height > flush || height < -deep) return false;
  const Piece floor(ground), piece(beside);
  if (!on_face(floor, up) || rises(piece, up, ground.point) > flush) return false;
  // Seen from above: the front of a triangle does not count from below.
  const Vec3 above = ground.at.inverse_point(beside.point + up * (deep - height));
  return point_distance(ground.solid, above, 2 * deep).has_value();
}

}  // namespace truestep
