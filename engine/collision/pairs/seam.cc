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
/// Cosine between normals that are the same but for rounding.
constexpr double kSame = 1 - 1e-12;

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

/// The normal (in the world) of the face that a contact with this normal belongs to.
std::optional<Vec3> face_touched(const Piece& p, const Vec3& normal) {
  const Vec3 n = p.at.inverse_direction(normal);
  Vec3 face;
  switch (p.shape.kind) {
    case SolidKind::plane:
      return normal;
    case SolidKind::box: {
      const Vec3 size{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
      face = size.x > std::max(size.y, size.z) ? Vec3{std::copysign(1.0, n.x), 0, 0}
             : size.y > size.z                 ? Vec3{0, std::copysign(1.0, n.y), 0}
                                               : Vec3{0, 0, std::copysign(1.0, n.z)};
      break;
    }
    case SolidKind::triangle:
      face = p.triangle->normal;
      break;
    case SolidKind::hull: {
      PolyhedronStorage storage;
      const Polyhedron faces = polyhedron(p.shape, storage);
      face = faces.faces[face_towards(faces, n)].normal;
      break;
    }
    default:
      return {};
  }
  if (dot(face, n) > kOnFace) return p.at.direction(face);
  return {};
}

/// m by which the piece rises above the plane through `from` with this normal.
double rises(const Piece& p, const Vec3& up, const Vec3& from) {
  const Vec3 top = p.at.point(p.shape.support(p.at.inverse_direction(up)));
  return dot(up, top - from) + p.shape.radius();
}

}  // namespace

std::optional<Vec3> floor_normal(const Touched& ground) {
  return face_touched(Piece(ground), ground.normal);
}

Seam seam(const Touched& beside, const Floor& floor, double flush, double deep) {
  const Vec3& up = floor.up;
  if (beside.solid.kind == SolidKind::plane || dot(beside.normal, up) > kSame) return Seam::none;
  const double height = dot(up, beside.point - floor.ground.point);
  if (height > flush || height < -deep || rises(Piece(beside), up, floor.ground.point) > flush)
    return Seam::none;
  // Seen from above: the front of a triangle does not count from below.
  const Vec3 above = floor.ground.at.inverse_point(beside.point + up * (deep - height));
  if (!point_distance(floor.ground.solid, above, 2 * deep)) return Seam::none;
  return dot(beside.normal, up) > kOnFace ? Seam::goes_on : Seam::covered;
}

}  // namespace truestep
