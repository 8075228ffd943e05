#include "engine/reference/bullet_world.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/kernels/rigid/free_rotation.h"
#include "engine/kernels/rigid/impact_limits.h"
#include "engine/math/trig.h"
#include "engine/reference/bullet_joints.h"
#include "engine/rigid/constraint_colouring.h"
#include "engine/systems/rigid3d/rigid3d_state.h"

namespace truestep::reference {

using namespace rigid3d;

namespace space_columns = rigid3d::columns;

namespace {

const BodyKind& kind_of(const btCollisionObject* o) {
  return *static_cast<const BodyKind*>(o->getUserPointer());
}
double mix_friction(const btCollisionObject* a, const btCollisionObject* b) {
  return std::sqrt(kind_of(a).friction * kind_of(b).friction);
}
double mix_restitution(const btCollisionObject* a, const btCollisionObject* b) {
  return std::max(kind_of(a).restitution, kind_of(b).restitution);
}
double mix_rolling(const btCollisionObject* a, const btCollisionObject* b) {
  return std::max(kind_of(a).rolling, kind_of(b).rolling);
}
double mix_spinning(const btCollisionObject* a, const btCollisionObject* b) {
  const double mu = mix_friction(a, b);
  return std::max(kind_of(a).spin_arm(mu), kind_of(b).spin_arm(mu));
}

constexpr State::Column kSpacePoses[] = {space_columns::position, space_columns::velocity,
                                         space_columns::orientation, space_columns::angular_velocity};

}  // namespace

BulletScene::BulletScene(const Rigid3dDef& def, const BuildContext& context, std::vector<Issue>& issues)
    : bodies(rigid3d::build_bodies(def, context.seed)),
      joints(rigid3d::build_joints(def, bodies).joints),
      joint_defs(reference::joint_defs(def)),
      shapes(bodies.kinds, issues),
      restitution_speed(def.restitution_speed.value_or(
          slowest_bounce(norm(def.gravity.value_or(context.gravity)), context.dt))),
      sleep_speed(def.sleep_speed),
      sleeping(def.sleeping) {}

BulletWorld::BulletWorld(std::shared_ptr<const BulletScene> scene, const State& s)
    : scene_(std::move(scene)), ground_(0, nullptr, nullptr) {
  // How surfaces combine is a global setting of the library, and the same for every world.
  gCalculateCombinedFrictionCallback = mix_friction;
  gCalculateCombinedRestitutionCallback = mix_restitution;
  gCalculateCombinedRollingFrictionCallback = mix_rolling;
  gCalculateCombinedSpinningFrictionCallback = mix_spinning;
  world_.setGravity({0, 0, 0});
  world_.getSolverInfo().m_restitutionVelocityThreshold = scene_->restitution_speed;
  for (size_t i = 0; i < s.rows(space_columns::position); ++i) add_body(s, i);
  for (size_t k = 0; k < scene_->joints.size(); ++k) add_joint(s, k);
  remember(s);
}

BulletWorld::~BulletWorld() {
  for (const auto& j : joints_) {
    if (j) world_.removeConstraint(j.get());
  }
  for (const auto& b : bodies_) world_.removeRigidBody(b.get());
}

void BulletWorld::add_body(const State& s, size_t i) {
  const BodyKind& k = scene_->bodies.kinds[s.span<uint32_t>(space_columns::kind)[i]];
  btRigidBody::btRigidBodyConstructionInfo info(
      k.mass, nullptr, scene_->shapes.of(s.span<uint32_t>(space_columns::kind)[i]), bullet(k.moments));
  const double *x = s.f64(space_columns::position).data(), *q = s.f64(space_columns::orientation).data();
  info.m_startWorldTransform = bullet(Pose{load3(x, i), load_quat(q, i)});
  // Bullet multiplies velocities by (1 - damping)^h, which is exp(-c h).
  info.m_linearDamping = 1 - trig::exp(-k.linear_damping);
  info.m_angularDamping = 1 - trig::exp(-k.angular_damping);
  auto b = std::make_unique<btRigidBody>(info);
  if (k.fixed_rotation) b->setAngularFactor(0);
  // Set, so that the callbacks above are called for these too.
  b->setRollingFriction(k.rolling), b->setSpinningFriction(k.spin_arm(k.friction));
  b->setUserPointer(const_cast<BodyKind*>(&k));
  b->setUserIndex(static_cast<int>(i));
  b->setLinearVelocity(bullet(load3(s.f64(space_columns::velocity).data(), i)));
  b->setAngularVelocity(bullet(load3(s.f64(space_columns::angular_velocity).data(), i)));
  b->setFlags(BT_DISABLE_WORLD_GRAVITY | BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY);
  if (k.motion == BodyDef::Motion::kinematic) {
    b->setCollisionFlags(b->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  }
  if (k.sensor) b->setCollisionFlags(b->getCollisionFlags() | btCollisionObject::CF_NO_CONTACT_RESPONSE);
  if (k.moved_by_forces() && std::isfinite(k.inner)) {
    b->setCcdMotionThreshold(0.5 * k.inner), b->setCcdSweptSphereRadius(0.5 * k.inner);
  }
  b->setSleepingThresholds(scene_->sleep_speed, scene_->sleep_speed / std::max(k.reach, 1e-9));
  const bool never_sleeps = !(scene_->sleeping && k.can_sleep) && k.moved_by_forces();
  if (never_sleeps || k.motion == BodyDef::Motion::kinematic) {
    b->setActivationState(DISABLE_DEACTIVATION);
  } else if (s.span<uint32_t>(space_columns::asleep)[i]) {
    b->setActivationState(ISLAND_SLEEPING);
  }
  world_.addRigidBody(b.get(), static_cast<int>(k.category), static_cast<int>(k.mask));
  bodies_.push_back(std::move(b));
}

void BulletWorld::add_joint(const State& s, size_t k) {
  joints_.emplace_back();
  if (s.span<uint32_t>(space_columns::joint_broken)[k]) return;
  const auto body = [&](uint32_t row) -> btRigidBody& { return row == kNoBody ? ground_ : *bodies_[row]; };
  const uint32_t* held = s.span<uint32_t>(space_columns::joint_bodies).data() + 2 * k;
  const Joint& j = scene_->joints[k];
  joints_[k] = bullet_joint(scene_->joint_defs[k], j, body(held[0]), body(held[1]));
  world_.addConstraint(joints_[k].get(), !j.collide);
}

void BulletWorld::remember(const State& s) {
  read_.clear();
  for (const auto c : kSpacePoses) {
    const auto values = s.f64(c);
    read_.insert(read_.end(), values.begin(), values.end());
  }
  const auto ids = s.span<uint64_t>(space_columns::id);
  ids_.assign(ids.begin(), ids.end());
}

bool BulletWorld::matches(const BulletScene& scene, const State& s) const {
  if (&scene != scene_.get()) return false;
  const auto ids = s.span<uint64_t>(space_columns::id);
  if (!std::equal(ids.begin(), ids.end(), ids_.begin(), ids_.end())) return false;
  const double* at = read_.data();
  for (const auto c : kSpacePoses) {
    const auto values = s.f64(c);
    if (std::memcmp(values.data(), at, values.size_bytes()) != 0) return false;
    at += values.size();
  }
  const auto broken = s.span<uint32_t>(space_columns::joint_broken);
  for (size_t k = 0; k < joints_.size(); ++k) {
    if ((joints_[k] == nullptr) != (broken[k] != 0)) return false;
  }
  return true;
}

/// Kinematic bodies move by their velocity; Bullet derives it from the two poses.
void BulletWorld::drive(const State& s, double h) {
  const double *x = s.f64(space_columns::position).data(), *q = s.f64(space_columns::orientation).data();
  const double *v = s.f64(space_columns::velocity).data(), *w = s.f64(space_columns::angular_velocity).data();
  for (size_t i = 0; i < bodies_.size(); ++i) {
    if (!bodies_[i]->isKinematicObject()) continue;
    const Quat turned = normalized(free_rotation::turn(load3(w, i) * h) * load_quat(q, i));
    bodies_[i]->setInterpolationWorldTransform(bullet(Pose{load3(x, i), load_quat(q, i)}));
    bodies_[i]->setWorldTransform(bullet(Pose{load3(x, i) + load3(v, i) * h, turned}));
  }
}

void BulletWorld::step(State& s, double h, const std::vector<Vec3>& change, const std::vector<Vec3>& twist) {
  const auto asleep = s.span<uint32_t>(space_columns::asleep);
  for (size_t i = 0; i < bodies_.size(); ++i) {
    btRigidBody& b = *bodies_[i];
    const BodyKind& k = kind_of(&b);
    if (!k.moved_by_forces()) continue;
    if (!asleep[i] && !b.isActive()) b.activate(true);
    if (b.isActive()) b.applyCentralForce(bullet(change[i] * (k.mass / h)));
    if (b.isActive() && !twist.empty()) b.applyTorque(bullet(twist[i] / h));
  }
  for (size_t k = 0; k < joints_.size(); ++k) {
    if (joints_[k] && std::isfinite(scene_->joints[k].break_force))
      joints_[k]->setBreakingImpulseThreshold(scene_->joints[k].break_force * h);
  }
  drive(s, h);
  world_.stepSimulation(h, 0);
  const auto broken = s.span<uint32_t>(space_columns::joint_broken);
  for (size_t k = 0; k < joints_.size(); ++k) {
    if (!joints_[k] || joints_[k]->isEnabled()) continue;
    world_.removeConstraint(joints_[k].get());
    joints_[k].reset(), broken[k] = 1;
  }
  read_bodies(s);
  read_contacts(s);
  s.f64(space_columns::substep)[0] = h;
  remember(s);
}

void BulletWorld::read_bodies(State& s) {
  double *x = s.f64(space_columns::position).data(), *q = s.f64(space_columns::orientation).data();
  double *v = s.f64(space_columns::velocity).data(), *w = s.f64(space_columns::angular_velocity).data();
  const auto asleep = s.span<uint32_t>(space_columns::asleep);
  const auto calm = s.f64(space_columns::sleep_timer);
  for (size_t i = 0; i < bodies_.size(); ++i) {
    const btRigidBody& b = *bodies_[i];
    const BodyKind& k = kind_of(&b);
    if (k.motion == BodyDef::Motion::fixed) continue;
    const btQuaternion r = b.getWorldTransform().getRotation();
    const Quat before = load_quat(q, i);
    Quat now = normalized({r.w(), r.x(), r.y(), r.z()});
    // Of the two quaternions of this rotation, the one nearer to the last, so that it continues without a
    // jump.
    if (now.w * before.w + now.x * before.x + now.y * before.y + now.z * before.z < 0) {
      now = {-now.w, -now.x, -now.y, -now.z};
    }
    store3(x, i, from_bullet(b.getWorldTransform().getOrigin()));
    store_quat(q, i, now);
    if (!k.moved_by_forces()) continue;
    store3(v, i, from_bullet(b.getLinearVelocity()));
    store3(w, i, from_bullet(b.getAngularVelocity()));
    asleep[i] = !b.isActive();
    calm[i] = b.getDeactivationTime();
  }
}

void BulletWorld::read_contacts(State& s) {
  contacts_.clear();
  for (int m = 0; m < dispatcher_.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(m);
    const int n = manifold.getNumContacts();
    if (n == 0) continue;
    if (!kind_of(manifold.getBody0()).moved_by_forces() && !kind_of(manifold.getBody1()).moved_by_forces())
      continue;
    Row r{};
    r.bodies[0] = static_cast<uint32_t>(manifold.getBody0()->getUserIndex());
    r.bodies[1] = static_cast<uint32_t>(manifold.getBody1()->getUserIndex());
    const bool swapped = r.bodies[0] > r.bodies[1];
    if (swapped) std::swap(r.bodies[0], r.bodies[1]);
    r.points = static_cast<uint32_t>(n), r.depth = -HUGE_VAL;
    // Bullet's impulses push its first body along the normal; ours push the body with the higher row.
    const double sign = swapped ? 1 : -1;
    Vec3 normal, friction;
    for (int p = 0; p < n; ++p) {
      const btManifoldPoint& c = manifold.getContactPoint(p);
      normal += from_bullet(c.m_normalWorldOnB) * sign;
      friction += (from_bullet(c.m_lateralFrictionDir1) * c.m_appliedImpulseLateral1 +
                   from_bullet(c.m_lateralFrictionDir2) * c.m_appliedImpulseLateral2) *
                  sign;
      r.impulse[p] = c.m_appliedImpulse;
      r.depth = std::max<double>(r.depth, -c.getDistance());
    }
    store3(r.normal, 0, normalized(normal, {0, 1, 0}));
    store3(r.friction, 0, friction);
    contacts_.push_back(r);
  }
  std::stable_sort(contacts_.begin(), contacts_.end(), [](const Row& a, const Row& b) {
    return std::make_pair(a.bodies[0], a.bodies[1]) < std::make_pair(b.bodies[0], b.bodies[1]);
  });
  for (State::Column c = space_columns::contact_bodies; c < space_columns::contacts_end; ++c)
    s.resize(c, contacts_.size());
  for (size_t i = 0; i < contacts_.size(); ++i) {
    const Row& r = contacts_[i];
    std::copy_n(r.bodies, 2, s.span<uint32_t>(space_columns::contact_bodies).data() + 2 * i);
    s.span<uint32_t>(space_columns::contact_ids)[5 * i] = r.points;
    std::copy_n(r.normal, 3, s.f64(space_columns::contact_normal).data() + 3 * i);
    std::copy_n(r.impulse, 4, s.f64(space_columns::contact_impulse).data() + 4 * i);
    std::copy_n(r.friction, 4, s.f64(space_columns::contact_friction).data() + 4 * i);
    s.f64(space_columns::contact_depth)[i] = r.depth;
  }
}

}  // namespace truestep::reference
