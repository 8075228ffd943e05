#include "engine/reference/bullet_joints.h"

#include "engine/reference/bullet_shapes.h"

namespace truestep::reference {
namespace {

/// Bullet has the joint; limits, springs and motors of its own kind are not compared.
struct HasEquivalent {
  template <class D>
  bool operator()(const D& d) const {
    constexpr bool known = std::is_same_v<D, BallJointDef> || std::is_same_v<D, FixedJointDef> ||
                           std::is_same_v<D, HingeJointDef> || std::is_same_v<D, SliderJointDef> ||
                           std::is_same_v<D, CylindricalJointDef> || std::is_same_v<D, PlaneJointDef>;
    if constexpr (known) return !d.break_torque && !driven(d);
    return false;
  }
  static bool is_driven(const DriveDef& d) {
    return d.lower || d.upper || d.stiffness || d.damping || d.hertz || d.motor_speed || d.motor_target;
  }
  static bool driven(const HingeJointDef& d) { return is_driven(d); }
  static bool driven(const SliderJointDef& d) { return is_driven(d); }
  static bool driven(const CylindricalJointDef& d) {
    return (d.slide && is_driven(*d.slide)) || (d.turn && is_driven(*d.turn));
  }
  static bool driven(const JointDef&) { return false; }
};

btTransform frame(const Vec3& x, const Vec3& y, const Vec3& z, const Vec3& origin) {
  return btTransform(btMatrix3x3(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z), bullet(origin));
}

/// The joint's place in both bodies: its axis as Bullet's x.
struct Frames {
  explicit Frames(const Joint& j) {
    const auto axis = [](const Quat& q, const Vec3& e) { return rotation(q).apply(e); };
    const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    const auto place = [&](const Quat& q, const Vec3& anchor) {
      return frame(axis(q, x), axis(q, y), axis(q, z), anchor);
    };
    const auto hinge = [&](const Quat& q, const Vec3& anchor) {
      return frame(axis(q, y), axis(q, z), axis(q, x), anchor);
    };
    a = place(j.turn_a, j.anchor_a), b = place(j.turn_b, j.anchor_b);
    hinge_a = hinge(j.turn_a, j.anchor_a), hinge_b = hinge(j.turn_b, j.anchor_b);
  }
  btTransform a, b;
  btTransform hinge_a, hinge_b;  ///< the axis as z
};

struct Make {
  using Made = std::unique_ptr<btTypedConstraint>;
  const Joint& j;
  btRigidBody &a, &b;
  Frames at{j};

  Made operator()(const BallJointDef&) const {
    return std::make_unique<btPoint2PointConstraint>(a, b, bullet(j.anchor_a), bullet(j.anchor_b));
  }
  Made operator()(const FixedJointDef&) const {
    return std::make_unique<btFixedConstraint>(a, b, at.a, at.b);
  }
  Made operator()(const HingeJointDef&) const {
    return std::make_unique<btHingeConstraint>(a, b, at.hinge_a, at.hinge_b, true);
  }
  Made slides(double turn) const {
    auto c = std::make_unique<btSliderConstraint>(a, b, at.a, at.b, true);
    // A lower limit above the upper one: none.
    c->setLowerLinLimit(1), c->setUpperLinLimit(-1);
    c->setLowerAngLimit(turn), c->setUpperAngLimit(-turn);
    return c;
  }
  Made operator()(const SliderJointDef&) const { return slides(0); }
  Made operator()(const CylindricalJointDef&) const { return slides(1); }
  Made operator()(const PlaneJointDef&) const {
    auto c = std::make_unique<btGeneric6DofSpring2Constraint>(a, b, at.a, at.b);
    c->setLinearLowerLimit({0, 1, 1}), c->setLinearUpperLimit({0, -1, -1});
    c->setAngularLowerLimit({1, 0, 0}), c->setAngularUpperLimit({-1, 0, 0});
    return c;
  }
  template <class D>
  Made operator()(const D&) const {
    throw Error("internal", "a joint that was not refused has no equivalent");
  }
};

}  // namespace

void check_bullet_joints(const Rigid3dDef& def, std::vector<Issue>& issues) {
  for (size_t i = 0; i < def.joints.size(); ++i) {
    if (std::visit(HasEquivalent{}, def.joints[i])) continue;
    issues.push_back(
        {"/joints/" + std::to_string(i) + "/type", "no_equivalent", "this joint has no equivalent in Bullet",
         "", "ball, fixed, hinge, slider, cylindrical, plane, without limits, springs or motors", "", ""});
  }
}

std::unique_ptr<btTypedConstraint> bullet_joint(const AnyJointDef& def, const Joint& j, btRigidBody& a,
                                                btRigidBody& b) {
  return std::visit(Make{j, a, b}, def);
}

std::vector<AnyJointDef> joint_defs(const Rigid3dDef& def) {
  std::vector<AnyJointDef> out;
  for (const AnyJointDef& d : def.joints) out.insert(out.end(), static_cast<size_t>(joint_count(d)), d);
  return out;
}

}  // namespace truestep::reference
