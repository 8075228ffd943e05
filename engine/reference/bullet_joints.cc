#include "engine/reference/bullet_joints.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "engine/reference/bullet_shapes.h"

namespace truestep::reference {

using namespace rigid3d;
namespace {

/// The part of a joint that Bullet has no equivalent of, with its member; empty when there is none.
struct Lack {
  std::string member, why, allowed;
};

/// Bullet supports limits, speed motors and springs given in N/m.
std::optional<Lack> lack_of(const std::string& at, const DriveDef& d) {
  if (d.hertz) return Lack{at + "/hertz", "Bullet's springs are given by stiffness", "stiffness and damping"};
  if (d.motor_target) return Lack{at + "/motor_target", "Bullet's servos are not compared", "motor_speed"};
  return std::nullopt;
}

struct FindLack {
  using Found = std::optional<Lack>;
  static Found torque(const JointDef& d) {
    if (d.break_torque) return Lack{"/break_torque", "Bullet's joints break by impulse", "break_force"};
    return std::nullopt;
  }
  template <class D>
  static Found part(const std::string& at, const std::optional<D>& d) {
    return d ? lack_of(at, *d) : std::nullopt;
  }
  static Found first(std::initializer_list<Found> all) {
    for (const Found& f : all) {
      if (f) return f;
    }
    return std::nullopt;
  }
  Found operator()(const HingeJointDef& d) const { return first({torque(d), lack_of("", d)}); }
  Found operator()(const SliderJointDef& d) const { return first({torque(d), lack_of("", d)}); }
  Found operator()(const CylindricalJointDef& d) const {
    return first({torque(d), part("/slide", d.slide), part("/turn", d.turn)});
  }
  Found operator()(const UniversalJointDef& d) const {
    return first({torque(d), part("/turn", d.turn), part("/turn_b", d.turn_b)});
  }
  Found operator()(const SixDofJointDef& d) const {
    return first({torque(d), part("/x", d.x), part("/y", d.y), part("/z", d.z), part("/turn_x", d.turn_x),
                  part("/turn_y", d.turn_y), part("/turn_z", d.turn_z)});
  }
  Found operator()(const ConeTwistJointDef& d) const {
    const bool both = d.twist_lower.has_value() && d.twist_upper.has_value();
    const bool none = !d.twist_lower && !d.twist_upper;
    if (!none && !(both && *d.twist_lower == -*d.twist_upper))
      return Lack{"/twist_lower", "Bullet's limits of twist are alike in both directions", "-twist_upper"};
    return torque(d);
  }
  Found operator()(const BallJointDef& d) const { return torque(d); }
  Found operator()(const FixedJointDef& d) const { return torque(d); }
  Found operator()(const PlaneJointDef& d) const { return torque(d); }
  template <class D>
  Found operator()(const D&) const {
    return Lack{"/type", "this joint has no equivalent in Bullet",
                "ball, fixed, hinge, slider, cylindrical, plane, universal, cone_twist, six_dof"};
  }
};

btTransform frame(const Vec3& x, const Vec3& y, const Vec3& z, const Vec3& origin) {
  return btTransform(btMatrix3x3(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z), bullet(origin));
}

/// The joint's frames in both bodies: its axis as Bullet's x.
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
    // Our rotation axes may be ordered differently from the sliding axes.
    const Quat& t = j.turn_a;
    slide_a = place(j.slide_frame, j.anchor_a);
    slide_b = place(j.turn_b * Quat{t.w, -t.x, -t.y, -t.z} * j.slide_frame, j.anchor_b);
  }
  btTransform a, b;
  btTransform hinge_a, hinge_b;  ///< the axis as z
  btTransform slide_a, slide_b;  ///< axes of sliding
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
  /// A free degree of freedom, with its drive, if any.
  struct Way {
    int row;
    const DriveDef* drive;
  };
  static bool drives(const DriveDef& d) {
    return d.lower || d.upper || d.stiffness || d.damping || d.motor_speed;
  }
  /// All other degrees of freedom are locked.
  Made generic(std::span<const Way> ways) const { return generic(ways, at.a, at.b); }
  Made generic(std::span<const Way> ways, const btTransform& in_a, const btTransform& in_b) const {
    // Beyond these there is no limit: metres, and the range of Bullet's angles.
    constexpr double kFar = 1e6, kRound = 3.1;
    constexpr double kAnything = 1e10;  // N or N m
    auto c = std::make_unique<btGeneric6DofSpring2Constraint>(a, b, in_a, in_b);
    for (int row = 0; row < 6; ++row) c->setLimit(row, 0, 0);
    for (const auto& [row, d] : ways) {
      // Bullet's angles have the opposite sign.
      const double sign = row < 3 ? 1 : -1, far = row < 3 ? kFar : kRound;
      if (d && (d->lower || d->upper)) {
        const double one = sign * d->lower.value_or(-far), other = sign * d->upper.value_or(far);
        c->setLimit(row, std::min(one, other), std::max(one, other));
      } else {
        c->setLimit(row, 1, -1);  // a lower limit above the upper one: none
      }
      if (!d) continue;
      if (d->stiffness || d->damping) {
        c->enableSpring(row, true);
        c->setStiffness(row, d->stiffness.value_or(0)), c->setDamping(row, d->damping.value_or(0));
        c->setEquilibriumPoint(row, sign * d->rest);
      }
      if (d->motor_speed) {
        c->enableMotor(row, true);
        c->setTargetVelocity(row, sign * *d->motor_speed);
        c->setMaxMotorForce(row, d->max_motor.value_or(kAnything));
      }
    }
    return c;
  }
  template <class D>
  static const DriveDef* of(const std::optional<D>& d) {
    return d ? &*d : nullptr;
  }

  Made operator()(const HingeJointDef& d) const {
    if (drives(d)) return generic(std::array{Way{3, &d}});
    return std::make_unique<btHingeConstraint>(a, b, at.hinge_a, at.hinge_b, true);
  }
  Made slides(double turn) const {
    auto c = std::make_unique<btSliderConstraint>(a, b, at.a, at.b, true);
    c->setLowerLinLimit(1), c->setUpperLinLimit(-1);
    c->setLowerAngLimit(turn), c->setUpperAngLimit(-turn);
    return c;
  }
  Made operator()(const SliderJointDef& d) const {
    return drives(d) ? generic(std::array{Way{0, &d}}) : slides(0);
  }
  Made operator()(const CylindricalJointDef& d) const {
    return d.slide || d.turn ? generic(std::array{Way{0, of(d.slide)}, Way{3, of(d.turn)}}) : slides(1);
  }
  Made operator()(const PlaneJointDef&) const {
    return generic(std::array{Way{1, nullptr}, Way{2, nullptr}, Way{3, nullptr}});
  }
  Made operator()(const UniversalJointDef& d) const {
    return generic(std::array{Way{3, of(d.turn)}, Way{5, of(d.turn_b)}});
  }
  Made operator()(const SixDofJointDef& d) const {
    std::vector<Way> ways;
    const DriveDef* all[6] = {of(d.x), of(d.y), of(d.z), of(d.turn_x), of(d.turn_y), of(d.turn_z)};
    for (int row = 0; row < 6; ++row) {
      if (all[row]) ways.push_back({row, all[row]});
    }
    return generic(ways, at.slide_a, at.slide_b);
  }
  Made operator()(const ConeTwistJointDef& d) const {
    auto c = std::make_unique<btConeTwistConstraint>(a, b, at.a, at.b);
    const double swing = d.swing.value_or(BT_LARGE_FLOAT);
    c->setLimit(swing, swing, d.twist_upper.value_or(BT_LARGE_FLOAT));
    return c;
  }
  template <class D>
  Made operator()(const D&) const {
    throw Error("internal", "a joint that was not refused has no equivalent");
  }
};

}  // namespace

void check_bullet_scene(const Rigid3dDef& def, std::vector<Issue>& issues) {
  const auto refuse = [&](const std::string& pointer, const char* why) {
    issues.push_back({pointer, "no_equivalent", why, "", "leave it out", "", ""});
  };
  for (size_t i = 0; i < def.bodies.size(); ++i) {
    const rigid3d::BodyDef& body = common(def.bodies[i]);
    const std::string at = "/bodies/" + std::to_string(i);
    if (body.surface_velocity != Vec3{}) refuse(at + "/surface_velocity", "Bullet's surfaces do not move");
    if (body.one_way) refuse(at + "/one_way", "Bullet's bodies are solid from all sides");
  }
  for (size_t i = 0; i < def.joints.size(); ++i) {
    if (const auto lack = std::visit(FindLack{}, def.joints[i]))
      issues.push_back({"/joints/" + std::to_string(i) + lack->member, "no_equivalent", lack->why, "",
                        lack->allowed, "", ""});
  }
}

std::unique_ptr<btTypedConstraint> bullet_joint(const AnyJointDef& def, const Joint& j, btRigidBody& a,
                                                btRigidBody& b) {
  return std::visit(Make{j, a, b}, def);
}

std::vector<AnyJointDef> joint_defs(const Rigid3dDef& def) {
  std::vector<AnyJointDef> out;
  for (const AnyJointDef& d : def.joints)
    out.insert(out.end(), static_cast<size_t>(rigid3d::joint_count(d)), d);
  return out;
}

}  // namespace truestep::reference
