#include "engine/reference/bullet_joints.h"

#include "engine/reference/bullet_shapes.h"

namespace truestep::reference {
namespace {

bool has_equivalent(JointDef::Type type) {
  switch (type) {
    case JointDef::Type::ball:
    case JointDef::Type::fixed:
    case JointDef::Type::hinge:
    case JointDef::Type::slider:
    case JointDef::Type::cylindrical:
    case JointDef::Type::plane:
      return true;
    default:
      return false;
  }
}

btTransform frame(const Vec3& x, const Vec3& y, const Vec3& z, const Vec3& origin) {
  return btTransform(btMatrix3x3(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z), bullet(origin));
}

/// The joint's place in both bodies: its axis as Bullet's x.
struct Frames {
  explicit Frames(const Joint& j) {
    const Rotation back = rotation(j.turn);
    Vec3 in_b[3];
    for (int e = 0; e < 3; ++e) in_b[e] = back.apply_inverse(j.axes[e]);
    a = frame(j.axes[0], j.axes[1], j.axes[2], j.anchor_a);
    b = frame(in_b[0], in_b[1], in_b[2], j.anchor_b);
    hinge_a = frame(j.axes[1], j.axes[2], j.axes[0], j.anchor_a);
    hinge_b = frame(in_b[1], in_b[2], in_b[0], j.anchor_b);
  }
  btTransform a, b;
  btTransform hinge_a, hinge_b;  ///< the axis as z
};

}  // namespace

void check_bullet_joints(const Rigid3dDef& def, std::vector<Issue>& issues) {
  for (size_t i = 0; i < def.joints.size(); ++i) {
    if (has_equivalent(def.joints[i].type)) continue;
    issues.push_back({"/joints/" + std::to_string(i) + "/kind", "no_equivalent",
                      "this joint has no equivalent in Bullet", "",
                      "ball, fixed, hinge, slider, cylindrical, plane", "", ""});
  }
}

std::unique_ptr<btTypedConstraint> bullet_joint(JointDef::Type type, const Joint& j, btRigidBody& a,
                                                btRigidBody& b) {
  const Frames at(j);
  switch (type) {
    case JointDef::Type::ball:
      return std::make_unique<btPoint2PointConstraint>(a, b, bullet(j.anchor_a), bullet(j.anchor_b));
    case JointDef::Type::fixed:
      return std::make_unique<btFixedConstraint>(a, b, at.a, at.b);
    case JointDef::Type::hinge:
      return std::make_unique<btHingeConstraint>(a, b, at.hinge_a, at.hinge_b, true);
    case JointDef::Type::slider:
    case JointDef::Type::cylindrical: {
      auto c = std::make_unique<btSliderConstraint>(a, b, at.a, at.b, true);
      // A lower limit above the upper one: none.
      c->setLowerLinLimit(1), c->setUpperLinLimit(-1);
      const double turn = type == JointDef::Type::slider ? 0 : 1;
      c->setLowerAngLimit(turn), c->setUpperAngLimit(-turn);
      return c;
    }
    case JointDef::Type::plane: {
      auto c = std::make_unique<btGeneric6DofSpring2Constraint>(a, b, at.a, at.b);
      c->setLinearLowerLimit({0, 1, 1}), c->setLinearUpperLimit({0, -1, -1});
      c->setAngularLowerLimit({1, 0, 0}), c->setAngularUpperLimit({-1, 0, 0});
      return c;
    }
    default:
      break;
  }
  throw Error("internal", "a joint that was not refused has no equivalent");
}

std::vector<JointDef::Type> joint_types(const Rigid3dDef& def) {
  std::vector<JointDef::Type> out;
  for (const JointDef& d : def.joints) out.insert(out.end(), static_cast<size_t>(d.repeat), d.type);
  return out;
}

}  // namespace truestep::reference
