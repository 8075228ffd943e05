#include "tests/bench/rigid3d/engines.h"

#include <dlfcn.h>

#ifdef TRUESTEP_BULLET
#include <btBulletDynamicsCommon.h>
#endif

#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::bench {
using namespace rigid3d;
namespace {

using Shape = SpaceBody::Shape;

/// Position of a joint in the frame of one of its bodies, which starts unrotated.
Vec3 on_body(const SpaceScene& scene, int body, const SpaceJoint& j) {
  return j.anchor - scene.bodies[static_cast<size_t>(body)].pose.position;
}

Rigid3dDef def_of(const SpaceScene& scene, const OursSettings& settings) {
  Rigid3dDef def;
  def.gravity = scene.gravity, def.friction = kSpaceFriction;
  def.sleeping = settings.sleep == Sleep::allowed;
  if (scene.substeps > 0) def.substeps = scene.substeps;
  if (settings.numbers == OursSettings::Numbers::f64) def.precision = Rigid3dDef::Precision::f64;
  for (const SpaceBody& b : scene.bodies) {
    const auto add = [&](auto body) {
      const Quat& q = b.pose.orientation;
      body.position = b.pose.position, body.orientation = {q.w, q.x, q.y, q.z};
      body.velocity = b.velocity, body.angular_velocity = b.angular_velocity;
      body.density = kSpaceDensity;
      if (b.fixed) body.motion = BodyDef::Motion::fixed;
      if (!scene.collide) body.mask = 0;
      def.bodies.push_back(body);
    };
    if (b.shape == Shape::box) {
      BoxBodyDef d;
      d.half_extents = b.size;
      add(d);
    } else if (b.shape == Shape::sphere) {
      SphereBodyDef d;
      d.radius = b.size.x;
      add(d);
    } else if (b.shape == Shape::capsule) {
      CapsuleBodyDef d;
      d.radius = b.size.x, d.half_length = b.size.y;
      add(d);
    } else {
      HullBodyDef d;
      d.points = prism_points(b);
      add(d);
    }
  }
  for (const SpaceJoint& j : scene.joints) {
    const auto fixed = [&](int body) { return scene.bodies[static_cast<size_t>(body)].fixed; };
    if (fixed(j.a) && fixed(j.b)) continue;
    BallJointDef d;
    d.a = j.a, d.b = j.b, d.anchor = j.anchor;
    def.joints.push_back(d);
  }
  return def;
}

class Ours final : public SpaceEngine {
 public:
  Ours(const SpaceScene& scene, const OursSettings& settings)
      : system_(def_of(scene, settings), {}), state_(system_.initial_state()), arena_(settings.threads) {}
  void step() override {
    system_.step(state_, {static_cast<double>(count_) * kSpaceDt, kSpaceDt, count_, workspace_, arena_});
    ++count_;
  }
  SpaceState state(size_t i) const override {
    namespace c = rigid3d::columns;
    return {{load3(state_.f64(c::position).data(), i), load_quat(state_.f64(c::orientation).data(), i)},
            load3(state_.f64(c::velocity).data(), i),
            load3(state_.f64(c::angular_velocity).data(), i)};
  }
  bool asleep(size_t i) const override { return state_.span<uint32_t>(rigid3d::columns::asleep)[i] != 0; }

 private:
  Rigid3d system_;
  State state_;
  Workspace workspace_;
  ThreadArena arena_;
  uint64_t count_ = 0;
};

class Rapier final : public SpaceEngine {
 public:
  Rapier(const RapierLibrary& library, const SpaceScene& scene, Sleep sleep)
      : library_(library), world_(library.create(&scene.gravity.x)) {
    for (const SpaceBody& b : scene.bodies) {
      const Vec3 &x = b.pose.position, &v = b.velocity, &w = b.angular_velocity, I = moments(b);
      const Quat& q = b.pose.orientation;
      const double pose[] = {x.x, x.y, x.z, q.w, q.x, q.y, q.z}, motion[] = {v.x, v.y, v.z, w.x, w.y, w.z};
      std::vector<double> size{b.size.x, b.size.y, b.size.z};
      if (b.shape == Shape::prism) {
        const std::vector<Vec3> points = prism_points(b);
        size = {static_cast<double>(points.size())};
        for (const Vec3& p : points) size.insert(size.end(), {p.x, p.y, p.z});
      }
      library.body(world_, static_cast<int>(b.shape), size.data(), pose, motion, b.fixed, scene.collide,
                   sleep == Sleep::allowed, kSpaceDensity, kSpaceFriction, mass(b), &I.x);
    }
    for (const SpaceJoint& j : scene.joints) {
      const Vec3 on_a = on_body(scene, j.a, j), on_b = on_body(scene, j.b, j);
      library.ball(world_, j.a, j.b, &on_a.x, &on_b.x);
    }
  }
  void step() override { library_.step(world_, kSpaceDt); }
  SpaceState state(size_t i) const override {
    double m[13];
    library_.motion(world_, static_cast<int>(i), m);
    return {{{m[0], m[1], m[2]}, {m[3], m[4], m[5], m[6]}}, {m[7], m[8], m[9]}, {m[10], m[11], m[12]}};
  }
  bool asleep(size_t i) const override { return library_.asleep(world_, static_cast<int>(i)) != 0; }

 private:
  const RapierLibrary& library_;
  void* world_;  // lives as long as the process
};

#ifdef TRUESTEP_BULLET
btVector3 vector(const Vec3& a) {
  return {btScalar(a.x), btScalar(a.y), btScalar(a.z)};
}

class Bullet final : public SpaceEngine {
 public:
  Bullet(const SpaceScene& scene, Sleep sleep) {
    world_.setGravity(vector(scene.gravity));
    for (const SpaceBody& b : scene.bodies) add(b, scene.collide, sleep);
    for (const SpaceJoint& j : scene.joints) {
      joints_.push_back(std::make_unique<btPoint2PointConstraint>(
          *bodies_[static_cast<size_t>(j.a)], *bodies_[static_cast<size_t>(j.b)],
          vector(on_body(scene, j.a, j)), vector(on_body(scene, j.b, j))));
      world_.addConstraint(joints_.back().get(), true);
    }
  }
  ~Bullet() override {
    for (const auto& j : joints_) world_.removeConstraint(j.get());
    for (const auto& b : bodies_) world_.removeRigidBody(b.get());
  }
  void step() override { world_.stepSimulation(kSpaceDt, 0, kSpaceDt); }
  SpaceState state(size_t i) const override {
    const btTransform& at = bodies_[i]->getWorldTransform();
    const auto back = [](const btVector3& a) { return Vec3{a.x(), a.y(), a.z()}; };
    const btQuaternion q = at.getRotation();
    return {{back(at.getOrigin()), {q.w(), q.x(), q.y(), q.z()}},
            back(bodies_[i]->getLinearVelocity()),
            back(bodies_[i]->getAngularVelocity())};
  }
  bool asleep(size_t i) const override { return !bodies_[i]->isActive(); }

 private:
  void add(const SpaceBody& b, bool collide, Sleep sleep) {
    const btScalar radius(b.size.x), length(2 * b.size.y);
    if (b.shape == Shape::box) {
      shapes_.push_back(std::make_unique<btBoxShape>(vector(b.size)));
    } else if (b.shape == Shape::sphere) {
      shapes_.push_back(std::make_unique<btSphereShape>(radius));
    } else if (b.shape == Shape::capsule) {
      shapes_.push_back(std::make_unique<btCapsuleShape>(radius, length));
    } else {
      auto hull = std::make_unique<btConvexHullShape>();
      for (const Vec3& p : prism_points(b)) hull->addPoint(vector(p));
      // Bullet adds the margin outside a hull, but inside a box.
      hull->setMargin(0);
      shapes_.push_back(std::move(hull));
    }
    const Quat& q = b.pose.orientation;
    btRigidBody::btRigidBodyConstructionInfo info(b.fixed ? 0 : btScalar(mass(b)), nullptr,
                                                  shapes_.back().get(),
                                                  b.fixed ? btVector3(0, 0, 0) : vector(moments(b)));
    info.m_startWorldTransform =
        btTransform({btScalar(q.x), btScalar(q.y), btScalar(q.z), btScalar(q.w)}, vector(b.pose.position));
    info.m_friction = std::sqrt(btScalar(kSpaceFriction)), info.m_restitution = 0;
    info.m_linearDamping = info.m_angularDamping = 0;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    if (sleep == Sleep::never) bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    bodies_.back()->setLinearVelocity(vector(b.velocity));
    bodies_.back()->setAngularVelocity(vector(b.angular_velocity));
    if (collide) {
      world_.addRigidBody(bodies_.back().get());
    } else {
      world_.addRigidBody(bodies_.back().get(), 64, 0);
    }
  }
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
};
#endif

}  // namespace

std::unique_ptr<SpaceEngine> make_ours(const SpaceScene& scene, const OursSettings& settings) {
  return std::make_unique<Ours>(scene, settings);
}

std::unique_ptr<RapierLibrary> RapierLibrary::open(const char* path) {
  void* handle = dlopen(path, RTLD_NOW);
  if (!handle) return nullptr;
  auto l = std::make_unique<RapierLibrary>();
  const auto find = [&](auto& f, const char* name) {
    f = reinterpret_cast<std::remove_reference_t<decltype(f)>>(dlsym(handle, name));
    return f != nullptr;
  };
  const bool all = find(l->create, "peer_new") && find(l->body, "peer_body") && find(l->ball, "peer_ball") &&
                   find(l->step, "peer_step") && find(l->motion, "peer_motion") &&
                   find(l->asleep, "peer_asleep");
  return all ? std::move(l) : nullptr;
}

std::unique_ptr<SpaceEngine> RapierLibrary::make(const SpaceScene& scene, Sleep sleep) const {
  return std::make_unique<Rapier>(*this, scene, sleep);
}

std::unique_ptr<SpaceEngine> make_bullet([[maybe_unused]] const SpaceScene& scene,
                                         [[maybe_unused]] Sleep sleep) {
#ifdef TRUESTEP_BULLET
  return std::make_unique<Bullet>(scene, sleep);
#else
  return nullptr;
#endif
}

}  // namespace truestep::bench
