#include "engine/reference/bullet_shapes.h"

#include "engine/geometry/compound.h"
#include "engine/geometry/height_field.h"
#include "engine/geometry/triangle_mesh.h"

namespace truestep::reference {

using namespace rigid3d;
namespace {

// Bullet rounds hulls outwards by their margin; small, so that contact happens at the true surface.
constexpr double kHullMargin = 0.001;

void add_triangle(btTriangleMesh& mesh, const std::array<Vec3, 3>& c) {
  mesh.addTriangle(bullet(c[0]), bullet(c[1]), bullet(c[2]));
}

}  // namespace

BulletShapes::BulletShapes(std::span<const BodyKind> kinds, std::vector<Issue>& issues) {
  for (size_t i = 0; i < kinds.size(); ++i) {
    const BodyKind& k = kinds[i];
    if (k.group != 0) {
      issues.push_back({"/bodies/" + std::to_string(i) + "/group", "no_equivalent",
                        "Bullet's world has categories and masks only", "", "0", "", ""});
    }
    if (k.solid.kind == SolidKind::mesh && k.moved_by_forces()) {
      issues.push_back({"/bodies/" + std::to_string(i) + "/motion", "no_equivalent",
                        "meshes that forces move have no equivalent in Bullet's world", "\"dynamic\"",
                        "fixed, kinematic; or a hull or compound", "", ""});
      of_kind_.push_back(nullptr);
      continue;
    }
    of_kind_.push_back(make(k.solid));
  }
}

btCollisionShape* BulletShapes::keep(std::unique_ptr<btCollisionShape> shape) {
  shapes_.push_back(std::move(shape));
  return shapes_.back().get();
}

btCollisionShape* BulletShapes::surface(std::unique_ptr<btTriangleMesh> mesh) {
  meshes_.push_back(std::move(mesh));
  auto shape = std::make_unique<btBvhTriangleMeshShape>(meshes_.back().get(), true);
  shape->setMargin(0);
  return keep(std::move(shape));
}

btCollisionShape* BulletShapes::make(const Solid& s) {
  switch (s.kind) {
    case SolidKind::sphere:
      return keep(std::make_unique<btSphereShape>(s.size.x));
    case SolidKind::capsule:
      return keep(std::make_unique<btCapsuleShape>(s.size.x, 2 * s.size.y));
    case SolidKind::box:
      return keep(std::make_unique<btBoxShape>(bullet(s.size)));
    case SolidKind::cylinder:
      return keep(std::make_unique<btCylinderShape>(btVector3(s.size.x, s.size.y, s.size.x)));
    case SolidKind::plane:
      return keep(std::make_unique<btStaticPlaneShape>(bullet(s.size), 0));
    case SolidKind::hull: {
      auto hull = std::make_unique<btConvexHullShape>();
      for (const Vec3& v : s.hull->vertices) hull->addPoint(bullet(v), false);
      hull->setMargin(std::min(kHullMargin, 0.02 * s.hull->thickness));
      hull->recalcLocalAabb();
      return keep(std::move(hull));
    }
    case SolidKind::mesh: {
      auto mesh = std::make_unique<btTriangleMesh>();
      for (uint32_t i = 0; i < s.mesh->size(); ++i) add_triangle(*mesh, s.mesh->triangle(i).corner);
      return surface(std::move(mesh));
    }
    case SolidKind::height_field: {
      auto mesh = std::make_unique<btTriangleMesh>();
      for (uint32_t i = 0; i < s.heights->triangle_count(); ++i) {
        if (const auto corners = s.heights->corners(i)) add_triangle(*mesh, *corners);
      }
      return surface(std::move(mesh));
    }
    case SolidKind::compound: {
      auto compound = std::make_unique<btCompoundShape>();
      for (const Compound::Part& p : s.compound->parts()) {
        const Rotation& r = p.place.rotation;
        const btMatrix3x3 turn(r.row[0].x, r.row[0].y, r.row[0].z, r.row[1].x, r.row[1].y, r.row[1].z,
                               r.row[2].x, r.row[2].y, r.row[2].z);
        compound->addChildShape(btTransform(turn, bullet(p.place.position)), make(p.solid));
      }
      return keep(std::move(compound));
    }
    case SolidKind::triangle:
      break;
  }
  throw Error("internal", "a single triangle is no body");
}

}  // namespace truestep::reference
