#include "engine/reference/box2d_joints.h"

#include <cfloat>
#include <cmath>

#include "engine/math/trig.h"

namespace truestep::reference {

using rigid2d::Joint;
using rigid2d::JointKind;
using rigid2d::Model;

namespace {

void refuse(std::vector<Issue>& issues, const std::string& pointer, const std::string& why,
            const std::string& allowed) {
  issues.push_back({pointer, "no_equivalent", why, "", allowed, "", ""});
}

/// Index of the plain joint that hinges this body to something fixed: what a gear connects.
std::optional<size_t> bearing(const Model& model, uint32_t body) {
  for (size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& j = model.joints[i];
    if (j.kind == JointKind::revolute && j.b == body && !(model.bodies[j.a].inverse_mass > 0)) return i;
  }
  return std::nullopt;
}

void check_body(const rigid2d::BodyDef& d, const std::string& at, std::vector<Issue>& issues) {
  if (d.rolling_resistance.value_or(0) > 0)
    refuse(issues, at + "/rolling_resistance", "Box2D 2.4 has no rolling resistance", "0");
}

template <class D>
void frame(D& d, const Joint& j) {
  d.localAnchorA = vec(j.local_a), d.localAnchorB = vec(j.local_b);
}
template <class D>
void frame_with_angle(D& d, const Joint& j) {
  frame(d, j);
  d.referenceAngle = real(j.angle);
}
template <class D>
void linear_spring(D& d, const Joint& j, b2Body* a, b2Body* b) {
  if (j.hertz > 0)
    return b2LinearStiffness(d.stiffness, d.damping, real(j.hertz), real(j.damping_ratio), a, b);
  d.stiffness = real(j.stiffness), d.damping = real(j.damping);
}
template <class D>
void limits(D& d, const Joint& j, float& lower, float& upper) {
  d.enableLimit = j.has_lower || j.has_upper;
  lower = j.has_lower ? real(j.lower) : real(-1e6), upper = j.has_upper ? real(j.upper) : real(1e6);
  d.enableMotor = j.has_motor, d.motorSpeed = real(j.motor_speed);
}

}  // namespace

void check_box2d_scene(const rigid2d::Rigid2dDef& def, const Model& model, std::vector<Issue>& issues) {
  if (def.rolling_resistance > 0)
    refuse(issues, "/rolling_resistance", "Box2D 2.4 has no rolling resistance", "0");
  for (size_t i = 0; i < def.bodies.size(); ++i)
    check_body(def.bodies[i], "/bodies/" + std::to_string(i), issues);
  for (size_t i = 0; i < def.generators.size(); ++i) {
    const auto& body =
        std::visit([](const auto& g) -> const rigid2d::BodyDef& { return g.body; }, def.generators[i]);
    check_body(body, "/generators/" + std::to_string(i) + "/body", issues);
  }
  const size_t generated = model.joints.size() - def.joints.size();
  for (size_t i = 0; i < def.joints.size(); ++i) {
    const Joint& j = model.joints[generated + i];
    const std::string at = "/joints/" + std::to_string(i);
    if ((j.kind == JointKind::revolute || j.kind == JointKind::prismatic) && j.has_spring)
      refuse(issues, at + "/hertz", "Box2D 2.4 has no springs in this joint", "leave it out");
    if (j.has_target)
      refuse(issues, at + "/motor_target", "Box2D's motors have no target position", "motor_speed");
    if (j.at_velocity || j.at_spin)
      refuse(issues, at + (j.at_velocity ? "/velocity" : "/angular_velocity"),
             "Box2D's motor joints drive poses only", "move, turn");
    if (j.kind == JointKind::wheel && j.rest != 0)
      refuse(issues, at + "/rest", "Box2D's suspensions are at rest at 0", "0");
    if (j.kind != JointKind::gear) continue;
    if (!bearing(model, j.a))
      refuse(issues, at + "/a", "Box2D's gears want a revolute joint whose body b this is",
             "a body hinged to something fixed");
    if (!bearing(model, j.b))
      refuse(issues, at + "/b", "Box2D's gears want a revolute joint whose body b this is",
             "a body hinged to something fixed");
  }
}

b2Joint* add_box2d_joint(b2World& world, const Model& model, const Joint& j, std::span<b2Body* const> bodies,
                         std::span<b2Joint* const> joints, double dt) {
  b2Body *a = bodies[j.a], *b = bodies[j.b];
  const auto add = [&](auto& d) {
    d.bodyA = a, d.bodyB = b, d.collideConnected = j.collide;
    return world.CreateJoint(&d);
  };
  switch (j.kind) {
    case JointKind::revolute: {
      b2RevoluteJointDef d;
      frame_with_angle(d, j);
      limits(d, j, d.lowerAngle, d.upperAngle);
      d.maxMotorTorque = real(j.max_motor);
      return add(d);
    }
    case JointKind::prismatic: {
      b2PrismaticJointDef d;
      frame_with_angle(d, j);
      limits(d, j, d.lowerTranslation, d.upperTranslation);
      d.localAxisA = vec(j.axis), d.maxMotorForce = real(j.max_motor);
      return add(d);
    }
    case JointKind::wheel: {
      b2WheelJointDef d;
      frame(d, j);
      limits(d, j, d.lowerTranslation, d.upperTranslation);
      d.localAxisA = vec(j.axis), d.maxMotorTorque = real(j.max_motor);
      if (j.has_spring) linear_spring(d, j, a, b);
      return add(d);
    }
    case JointKind::distance: {
      b2DistanceJointDef d;
      frame(d, j);
      d.length = real(j.length);
      const bool free = j.has_spring || j.has_lower || j.has_upper;
      d.minLength = free ? real(j.lower) : d.length;
      d.maxLength = j.has_upper ? real(j.upper) : free ? FLT_MAX : d.length;
      if (j.has_spring) linear_spring(d, j, a, b);
      return add(d);
    }
    case JointKind::weld: {
      b2WeldJointDef d;
      frame_with_angle(d, j);
      if (j.has_spring)
        b2AngularStiffness(d.stiffness, d.damping, real(j.hertz), real(j.damping_ratio), a, b);
      return add(d);
    }
    case JointKind::motor: {
      b2MotorJointDef d;
      d.linearOffset = vec(j.local_a), d.angularOffset = real(j.angle);
      d.maxForce = real(j.max_force), d.maxTorque = real(j.max_torque),
      d.correctionFactor = real(1 - trig::exp(-j.motor_rate * dt));
      return add(d);
    }
    case JointKind::mouse: {
      b2MouseJointDef d;
      d.target = b->GetWorldPoint(vec(j.local_b)), d.maxForce = real(j.max_force);
      b2LinearStiffness(d.stiffness, d.damping, real(j.hertz), real(j.damping_ratio), a, b);
      b2Joint* joint = add(d);
      static_cast<b2MouseJoint*>(joint)->SetTarget(vec(j.ground_a));
      return joint;
    }
    case JointKind::gear: {
      b2GearJointDef d;
      d.joint1 = joints[*bearing(model, j.a)], d.joint2 = joints[*bearing(model, j.b)];
      if (!d.joint1 || !d.joint2) return nullptr;  // a bearing broke
      d.ratio = real(j.ratio);
      return add(d);
    }
    case JointKind::pulley: {
      b2PulleyJointDef d;
      frame(d, j);
      d.groundAnchorA = vec(j.ground_a), d.groundAnchorB = vec(j.ground_b), d.ratio = real(j.ratio);
      d.lengthA = (a->GetWorldPoint(d.localAnchorA) - d.groundAnchorA).Length();
      d.lengthB = real((j.length - d.lengthA) / j.ratio);
      return add(d);
    }
  }
  return nullptr;
}

std::array<double, 6> box2d_impulses(b2Joint& joint, const Joint& j, double dt, double h) {
  const auto rate = static_cast<float>(1 / dt);
  const b2Vec2 force = joint.GetReactionForce(rate);
  const double x = h * force.x, y = h * force.y, turn = h * joint.GetReactionTorque(rate);
  const b2Vec2 axis = joint.GetBodyA()->GetWorldVector(vec(j.axis));
  const double along = x * axis.x + y * axis.y, across = y * axis.x - x * axis.y;
  switch (j.kind) {
    case JointKind::revolute:
      return {x, y, turn, 0, 0, 0};
    case JointKind::weld:
    case JointKind::motor:
    case JointKind::mouse:
      return {x, y, 0, 0, 0, turn};
    case JointKind::prismatic:
      return {across, turn, along, 0, 0, 0};
    case JointKind::wheel:
      return {across, 0, turn, 0, 0, along};
    case JointKind::distance: {
      b2Vec2 line = joint.GetAnchorB() - joint.GetAnchorA();
      line.Normalize();
      return {x * line.x + y * line.y, 0, 0, 0, 0, 0};
    }
    case JointKind::gear:
      return {turn / j.ratio, 0, 0, 0, 0, 0};
    case JointKind::pulley:
      return {std::hypot(x, y) / j.ratio, 0, 0, 0, 0, 0};
  }
  return {};
}

}  // namespace truestep::reference
