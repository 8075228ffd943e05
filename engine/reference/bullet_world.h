// Bullet's world of one state: built from it, stepped, and read back into it.
#pragma once
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "engine/core/state/state.h"
#include "engine/reference/bullet_shapes.h"
#include "engine/systems/rigid3d/joints/joints.h"

namespace truestep::reference {

/// What a world is made from; constant.
struct BulletScene {
  BulletScene(const rigid3d::Rigid3dDef& def, const BuildContext& context, std::vector<Issue>& issues);

  rigid3d::BodyList bodies;
  std::vector<rigid3d::Joint> joints;
  std::vector<rigid3d::AnyJointDef> joint_defs;
  BulletShapes shapes;
  double restitution_speed, sleep_speed;
  bool sleeping;
};

class BulletWorld {
 public:
  BulletWorld(std::shared_ptr<const BulletScene> scene, const State& state);
  ~BulletWorld();
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  /// True when it belongs to this scene and nothing but sleep differs from what was last read back.
  bool matches(const BulletScene& scene, const State& s) const;
  /// One step of h (s), in which forces change the velocities by `change` (m/s per row) and the angular
  /// momenta by `twist` (N m s per row, or empty).
  void step(State& s, double h, const std::vector<Vec3>& change, const std::vector<Vec3>& twist);

 private:
  void add_body(const State& s, size_t row);
  void add_joint(const State& s, size_t k);
  void drive(const State& s, double h);
  void read_bodies(State& s);
  void read_contacts(State& s);
  void remember(const State& s);

  std::shared_ptr<const BulletScene> scene_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};
  btRigidBody ground_;  ///< the body that joints to the world attach to
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;  ///< null: broken
  std::vector<double> read_;                                ///< poses and velocities as last read back
  std::vector<uint64_t> ids_;

  struct Row {
    uint32_t bodies[2];
    uint32_t points;
    double normal[3], impulse[4], friction[4], depth;
  };
  std::vector<Row> contacts_;
};

}  // namespace truestep::reference
