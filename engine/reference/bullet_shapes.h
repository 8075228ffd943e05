// Bullet's shapes of the bodies of a scene, in the frames of their centres of mass and principal axes.
#pragma once
#include <btBulletCollisionCommon.h>

#include <memory>
#include <span>
#include <vector>

#include "engine/base/errors.h"
#include "engine/systems/rigid3d/bodies.h"

namespace truestep::reference {

inline btVector3 bullet(const Vec3& v) {
  return {v.x, v.y, v.z};
}
inline btQuaternion bullet(const Quat& q) {
  return {q.x, q.y, q.z, q.w};
}
inline btTransform bullet(const Pose& p) {
  return btTransform(bullet(p.orientation), bullet(p.position));
}
inline Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Immutable once built; worlds share it.
class BulletShapes {
 public:
  /// Appends an issue for every kind of body that Bullet does not support.
  BulletShapes(std::span<const rigid3d::BodyKind> kinds, std::vector<Issue>& issues);
  btCollisionShape* of(uint32_t kind) const { return of_kind_[kind]; }

 private:
  btCollisionShape* make(const Solid& solid);
  btCollisionShape* keep(std::unique_ptr<btCollisionShape> shape);
  btCollisionShape* surface(std::unique_ptr<btTriangleMesh> mesh);

  std::vector<std::unique_ptr<btTriangleMesh>> meshes_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;  ///< parts before the compounds that contain them
  std::vector<btCollisionShape*> of_kind_;
};

}  // namespace truestep::reference
