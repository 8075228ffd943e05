#include "engine/reference/box2d_world.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/kernels/rigid/impact_limits.h"
#include "engine/reference/box2d_joints.h"
#include "engine/systems/rigid2d/columns.h"
#include "engine/systems/rigid2d/pairs.h"

namespace truestep::reference {

namespace columns = rigid2d::columns;
using flat::Outline;
using flat::Vec2;
using rigid2d::Body;
using rigid2d::Motion;

namespace {

// As in the library's own examples.
constexpr int kVelocityIterations = 8, kPositionIterations = 3;

constexpr State::Column kFlatPoses[] = {columns::position, columns::velocity, columns::angle,
                                        columns::angular_velocity};

uint32_t shape_of(const b2Fixture& f) {
  return static_cast<uint32_t>(const_cast<b2Fixture&>(f).GetUserData().pointer);
}
uint64_t key_of(const b2Contact& c) {
  const uint32_t a = shape_of(*const_cast<b2Contact&>(c).GetFixtureA()),
                 b = shape_of(*const_cast<b2Contact&>(c).GetFixtureB());
  return uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

/// Filled by hand: Set would drop corners closer than 2.5 mm and asserts that three remain.
b2PolygonShape polygon(const Outline& o) {
  b2PolygonShape p;
  p.m_count = static_cast<int32>(o.corners);
  for (uint32_t i = 0; i < o.corners; ++i)
    p.m_vertices[i] = vec(o.corner[i]), p.m_normals[i] = vec(o.normal[i]);
  p.m_centroid = vec(o.center), p.m_radius = real(o.radius);
  return p;
}

b2CircleShape circle(Vec2 at, double radius) {
  b2CircleShape c;
  c.m_p = vec(at), c.m_radius = real(radius);
  return c;
}

}  // namespace

Box2dScene::Box2dScene(const rigid2d::Rigid2dDef& def, const BuildContext& context)
    : model(rigid2d::build_model(def)),
      restitution_speed(def.restitution_speed.value_or(
          slowest_bounce(norm(def.gravity.value_or(context.gravity)), context.dt))),
      parts(static_cast<double>(def.substeps)),
      dt(context.dt),
      sleeping(def.sleeping) {}

Box2dWorld::Box2dWorld(std::shared_ptr<const Box2dScene> scene, const State& s) : scene_(std::move(scene)) {
  world_.SetContactFilter(this);
  world_.SetContactListener(this);
  world_.SetAllowSleeping(scene_->sleeping);
  for (size_t i = 0; i < scene_->model.count(); ++i) add_body(s, i);
  const b2BodyDef ground;
  bodies_.push_back(world_.CreateBody(&ground));
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  // Gears connect joints that already exist.
  joints_.assign(broken.size(), nullptr);
  for (const bool gears : {false, true}) {
    for (size_t k = 0; k < broken.size(); ++k) {
      const rigid2d::Joint& j = scene_->model.joints[k];
      if (broken[k] || (j.kind == rigid2d::JointKind::gear) != gears) continue;
      joints_[k] = add_box2d_joint(world_, scene_->model, j, bodies_, joints_, scene_->dt);
    }
  }
  remember(s);
}

void Box2dWorld::add_body(const State& s, size_t i) {
  const Body& b = scene_->model.bodies[i];
  const uint32_t status = s.span<uint32_t>(columns::status)[i];
  const double *x = s.f64(columns::position).data() + 3 * i, *v = s.f64(columns::velocity).data() + 3 * i;
  b2BodyDef d;
  const bool moves = b.motion == Motion::dynamic && !(status & rigid2d::kPinned);
  d.type = moves ? b2_dynamicBody : b.motion == Motion::kinematic ? b2_kinematicBody : b2_staticBody;
  d.position = vec({x[0], x[1]}), d.angle = real(s.f64(columns::angle)[i]);
  if (d.type != b2_staticBody) {
    d.linearVelocity = vec({v[0], v[1]}), d.angularVelocity = real(s.f64(columns::angular_velocity)[i]);
  }
  d.linearDamping = real(b.linear_damping), d.angularDamping = real(b.angular_damping);
  d.gravityScale = real(b.gravity_scale);
  d.fixedRotation = b.inverse_inertia == 0, d.bullet = b.bullet, d.allowSleep = b.can_sleep;
  d.awake = !moves || (status & rigid2d::kAwake), d.enabled = !(status & rigid2d::kRemoved);
  d.userData.pointer = i;
  bodies_.push_back(world_.CreateBody(&d));
  for (uint32_t k = b.first_shape; k < b.first_shape + b.shapes; ++k)
    add_shape(*bodies_.back(), scene_->model.shapes[k], k);
  if (!moves) return;
  const b2MassData mass{real(b.mass), {0, 0}, real(b.inertia)};
  bodies_.back()->SetMassData(&mass);
}

void Box2dWorld::add_shape(b2Body& body, const rigid2d::Shape& shape, uint32_t number) {
  const Body& b = scene_->model.bodies[shape.body];
  const Outline& o = shape.outline;
  b2FixtureDef d;
  d.friction = real(b.friction), d.restitution = real(b.restitution);
  d.restitutionThreshold = real(scene_->restitution_speed);
  d.isSensor = b.sensor, d.userData.pointer = number;
  const auto add = [&](const b2Shape& s) {
    d.shape = &s;
    body.CreateFixture(&d);
  };
  if (o.is_link()) {
    // Box2D's edges are solid on the other side.
    b2EdgeShape edge;
    if (o.side == Outline::Side::both) {
      edge.SetTwoSided(vec(o.corner[0]), vec(o.corner[1]));
    } else {
      edge.SetOneSided(vec(o.after), vec(o.corner[1]), vec(o.corner[0]), vec(o.before));
    }
    edge.m_radius = real(o.radius);
    add(edge);
  } else if (o.corners == 1) {
    add(circle(o.corner[0], o.radius));
  } else if (o.corners == 2) {
    // A capsule: a box between two disks.
    const Vec2 n = o.normal[0];
    Outline box = o;
    box.corners = 4, box.radius = 0;
    box.corner[0] = o.corner[0] + o.radius * n, box.corner[1] = o.corner[1] + o.radius * n;
    box.corner[2] = o.corner[1] - o.radius * n, box.corner[3] = o.corner[0] - o.radius * n;
    const Vec2 along = flat::unit(o.corner[1] - o.corner[0]);
    box.normal[0] = n, box.normal[1] = along, box.normal[2] = -n, box.normal[3] = -along;
    add(polygon(box)), add(circle(o.corner[0], o.radius)), add(circle(o.corner[1], o.radius));
  } else {
    add(polygon(o));
  }
}

void Box2dWorld::remember(const State& s) {
  read_.clear(), marks_.clear();
  for (const auto c : kFlatPoses) {
    const auto values = s.f64(c);
    read_.insert(read_.end(), values.begin(), values.end());
  }
  for (const uint32_t m : s.span<uint32_t>(columns::status))
    marks_.push_back(m & (rigid2d::kPinned | rigid2d::kRemoved));
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  marks_.insert(marks_.end(), broken.begin(), broken.end());
}

bool Box2dWorld::matches(const Box2dScene& scene, const State& s) const {
  if (&scene != scene_.get()) return false;
  const double* at = read_.data();
  for (const auto c : kFlatPoses) {
    const auto values = s.f64(c);
    if (std::memcmp(values.data(), at, values.size_bytes()) != 0) return false;
    at += values.size();
  }
  size_t k = 0;
  for (const uint32_t m : s.span<uint32_t>(columns::status)) {
    if (marks_[k++] != (m & (rigid2d::kPinned | rigid2d::kRemoved))) return false;
  }
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  return std::equal(broken.begin(), broken.end(), marks_.begin() + static_cast<ptrdiff_t>(k));
}

/// Pushes as forces, drags as joints for this step.
std::vector<b2Joint*> Box2dWorld::take_hands(State& s, double h) {
  for (const uint32_t i : scene_->model.forced) {
    const Body& own = scene_->model.bodies[i];
    b2Body& b = *bodies_[i];
    if (b.GetType() != b2_dynamicBody) continue;
    const b2Vec2 f = vec(own.force);
    b.ApplyForceToCenter(own.force_turns ? b.GetWorldVector(f) : f, true);
    b.ApplyTorque(real(own.torque), true);
  }
  for (size_t k = 0; k < columns::kHands.pushes(s); ++k) {
    const UserForces::Push p = columns::kHands.push(s, k);
    b2Body& b = *bodies_[p.who];
    b.ApplyForce(vec({p.force.x, p.force.y}), b.GetWorldPoint(vec(flat::flatten(p.at))), true);
  }
  columns::kHands.count_down(s, h);
  std::vector<b2Joint*> drags;
  for (size_t k = 0; k < columns::kHands.drags(s); ++k) {
    const UserForces::Drag d = columns::kHands.drag(s, k);
    if (bodies_[d.who]->GetType() != b2_dynamicBody) continue;
    bodies_[d.who]->SetAwake(true);
    const rigid2d::Joint j = rigid2d::drag_joint(scene_->model, d);
    drags.push_back(add_box2d_joint(world_, scene_->model, j, bodies_, joints_, scene_->dt));
  }
  return drags;
}

void Box2dWorld::step(State& s, double h) {
  const auto status = s.span<uint32_t>(columns::status);
  for (size_t i = 0; i < scene_->model.count(); ++i) {
    if ((status[i] & rigid2d::kAwake) && !bodies_[i]->IsAwake()) bodies_[i]->SetAwake(true);
  }
  const auto g = s.f64(columns::parameters);
  world_.SetGravity(vec({g[0], g[1]}));
  const auto drags = take_hands(s, h);
  world_.Step(static_cast<float>(h), kVelocityIterations, kPositionIterations);
  for (b2Joint* j : drags) world_.DestroyJoint(j);
  read_bodies(s);
  read_contacts(s);
  remember(s);
  // Last, so that the next step builds a world without the broken joints.
  read_joints(s, h);
}

void Box2dWorld::read_joints(State& s, double h) {
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  for (size_t k = 0; k < joints_.size(); ++k) {
    const rigid2d::Joint& j = scene_->model.joints[k];
    if (!joints_[k]) continue;
    const auto impulses = box2d_impulses(*joints_[k], j, h, h / scene_->parts);
    std::copy(impulses.begin(), impulses.end(), s.f64(columns::joint_impulse).data() + 6 * k);
    const auto rate = static_cast<float>(1 / h);
    if ((j.break_force > 0 && joints_[k]->GetReactionForce(rate).Length() > j.break_force) ||
        (j.break_torque > 0 && std::abs(joints_[k]->GetReactionTorque(rate)) > j.break_torque))
      broken[k] = 1;
  }
}

void Box2dWorld::read_bodies(State& s) {
  double *x = s.f64(columns::position).data(), *v = s.f64(columns::velocity).data();
  const auto angle = s.f64(columns::angle), w = s.f64(columns::angular_velocity);
  const auto status = s.span<uint32_t>(columns::status);
  for (size_t i = 0; i < scene_->model.count(); ++i) {
    const b2Body& b = *bodies_[i];
    if (b.GetType() == b2_staticBody) continue;
    store3(x, i, Vec3{b.GetPosition().x, b.GetPosition().y, 0});
    angle[i] = b.GetAngle();
    if (b.GetType() == b2_kinematicBody) continue;
    store3(v, i, Vec3{b.GetLinearVelocity().x, b.GetLinearVelocity().y, 0});
    w[i] = b.GetAngularVelocity();
    status[i] = (status[i] & ~uint32_t{rigid2d::kAwake}) | (b.IsAwake() ? uint32_t{rigid2d::kAwake} : 0u);
  }
}

void Box2dWorld::read_contacts(State& s) {
  contacts_.clear();
  for (b2Contact* c = world_.GetContactList(); c; c = c->GetNext()) {
    if (!c->IsTouching() || !c->IsEnabled() || c->GetFixtureA()->IsSensor() || c->GetFixtureB()->IsSensor())
      continue;
    Row r{key_of(*c), {}};
    const b2Manifold& m = *c->GetManifold();
    const auto part = static_cast<float>(1 / scene_->parts);
    for (int32 k = 0; k < m.pointCount; ++k) {
      r.impulse[k] = m.points[k].normalImpulse * part, r.impulse[2 + k] = m.points[k].tangentImpulse * part;
    }
    contacts_.push_back(r);
  }
  std::stable_sort(contacts_.begin(), contacts_.end(),
                   [](const Row& a, const Row& b) { return a.key < b.key; });
  // A capsule's parts count as one shape.
  size_t kept = 0;
  for (const Row& r : contacts_) {
    if (kept > 0 && contacts_[kept - 1].key == r.key) {
      for (int k = 0; k < 5; ++k) contacts_[kept - 1].impulse[k] += r.impulse[k];
    } else {
      contacts_[kept++] = r;
    }
  }
  contacts_.resize(kept);
  for (const auto c :
       {columns::contact_key, columns::contact_id, columns::contact_impulse, columns::contact_offset})
    s.resize(c, kept);
  for (size_t i = 0; i < kept; ++i) {
    s.span<uint64_t>(columns::contact_key)[i] = contacts_[i].key;
    s.span<uint32_t>(columns::contact_id)[2 * i] = 0;
    s.span<uint32_t>(columns::contact_id)[2 * i + 1] = rigid2d::kNoPoint;
    std::copy_n(contacts_[i].impulse, 5, s.span<float>(columns::contact_impulse).data() + 5 * i);
  }
}

bool Box2dWorld::ShouldCollide(b2Fixture* a, b2Fixture* b) {
  return rigid2d::may_touch(scene_->model, static_cast<uint32_t>(a->GetBody()->GetUserData().pointer),
                            static_cast<uint32_t>(b->GetBody()->GetUserData().pointer));
}

void Box2dWorld::PreSolve(b2Contact* c, const b2Manifold* old) {
  const auto body = [](b2Fixture* f) { return static_cast<uint32_t>(f->GetBody()->GetUserData().pointer); };
  const uint32_t a = body(c->GetFixtureA()), b = body(c->GetFixtureB());
  const Body &first = scene_->model.bodies[a], &second = scene_->model.bodies[b];
  c->SetTangentSpeed(real(first.surface_speed + second.surface_speed));
  if (!first.one_way && !second.one_way) return;
  // A one-way platform holds what lands on it from outside, and keeps holding it.
  const uint64_t key = key_of(*c);
  if (old->pointCount > 0 && !passing_.contains(key)) return;
  b2WorldManifold at;
  c->GetWorldManifold(&at);
  float deepest = 0;
  for (int32 k = 0; k < c->GetManifold()->pointCount; ++k) deepest = std::min(deepest, at.separations[k]);
  const auto through = [&](const Body& platform, uint32_t which, uint32_t other, b2Vec2 n) {
    const b2Vec2 up = bodies_[which]->GetWorldVector(vec(platform.one_way_direction));
    const b2Vec2 relative = bodies_[other]->GetLinearVelocity() - bodies_[which]->GetLinearVelocity();
    return b2Dot(n, up) < 0.5F || b2Dot(relative, up) > 0 || deepest < -scene_->model.margin;
  };
  if ((first.one_way && through(first, a, b, at.normal)) ||
      (second.one_way && through(second, b, a, -at.normal))) {
    passing_.insert(key);
    c->SetEnabled(false);
  } else {
    passing_.erase(key);
  }
}

void Box2dWorld::EndContact(b2Contact* c) {
  passing_.erase(key_of(*c));
}

}  // namespace truestep::reference
