#include "engine/systems/rigid2d/joint_tables.h"

namespace truestep::rigid2d {
namespace {

template <class D>
TableOf<D>& joint_rows(TableOf<D>& t) {
  std::string D::*id = &JointDef::id;
  int64_t D::*a = &JointDef::a;
  int64_t D::*b = &JointDef::b;
  std::optional<Vec3> D::*anchor = &JointDef::anchor;
  std::optional<double> D::*break_force = &JointDef::break_force;
  std::optional<double> D::*break_torque = &JointDef::break_torque;
  bool D::*collide = &JointDef::collide;
  return t.text("id", id, "name; its force, torque and coordinates are observed as joint.ID.force and so on")
      .integer("a", a, between(-1, kMostBodies),
               "first body; listed bodies are numbered before generated ones; -1: the world")
      .integer("b", b, between(-1, kMostBodies), "second body, numbered like a")
      .vector("anchor", anchor, "m", any(), "point in the world at t = 0; absent: midway between the bodies")
      .number("break_force", break_force, "N", above(0), "force at which it breaks; absent: never")
      .number("break_torque", break_torque, "N m", above(0), "torque at which it breaks; absent: never")
      .boolean("collide", collide, "whether its bodies collide with one another");
}

struct Units {
  const char *at, *rate, *force, *stiffness, *damping;
};
constexpr Units kSlide{"m", "m/s", "N", "N/m", "N s/m"}, kTurn{"rad", "rad/s", "N m", "N m/rad", "N m s/rad"};

template <class D>
TableOf<D>& limit_rows(TableOf<D>& t, const Units& unit) {
  std::optional<double> D::*lower = &Drive::lower;
  std::optional<double> D::*upper = &Drive::upper;
  return t.number("lower", lower, unit.at, any(), "smallest coordinate, 0 at t = 0")
      .number("upper", upper, unit.at, any(), "largest coordinate");
}

template <class D>
TableOf<D>& motor_rows(TableOf<D>& t, const Units& unit) {
  std::optional<double> D::*speed = &Drive::motor_speed;
  std::optional<double> D::*target = &Drive::motor_target;
  std::optional<double> D::*strength = &Drive::max_motor;
  double D::*rate = &Drive::motor_rate;
  return t.number("motor_speed", speed, unit.rate, any(), "target speed of the motor; absent: none")
      .number("motor_target", target, unit.at, any(), "target position of the motor, instead of motor_speed")
      .number("max_motor", strength, unit.force, at_least(0),
              "maximum force or torque of the motor; absent: unlimited")
      .number("motor_rate", rate, "1/s", above(0), "rate at which the remaining error decays");
}

template <class D>
TableOf<D>& stiffness_rows(TableOf<D>& t, const Units& unit) {
  std::optional<double> D::*stiffness = &Drive::stiffness;
  std::optional<double> D::*damping = &Drive::damping;
  double D::*rest = &Drive::rest;
  return t
      .number("stiffness", stiffness, unit.stiffness, at_least(0),
              "stiffness of a spring towards rest; absent: none")
      .number("damping", damping, unit.damping, at_least(0), "of the spring, or damping alone")
      .number("rest", rest, unit.at, any(), "rest position of the spring");
}

template <class D>
TableOf<D>& drive_rows(TableOf<D>& t, const Units& unit) {
  std::optional<double> D::*hertz = &Drive::hertz;
  double D::*ratio = &Drive::damping_ratio;
  return stiffness_rows(motor_rows(limit_rows(t, unit), unit), unit)
      .number("hertz", hertz, "Hz", above(0),
              "instead of stiffness: natural frequency of the bodies in their pose at t = 0")
      .number("damping_ratio", ratio, "1", at_least(0), "of a spring given by hertz");
}

/// Reports contradictions between the members of a drive.
void check_drive(const Drive& d, const DefTable::Report& report) {
  if (d.lower && d.upper && *d.lower > *d.upper) report("/lower", "lower must not be above upper");
  if (d.hertz && (d.stiffness || d.damping)) {
    report("/hertz", "give a spring by hertz and damping_ratio or by stiffness and damping");
  }
  if (d.motor_speed && d.motor_target) report("/motor_target", "a motor has either a speed or a target");
}

}  // namespace

const DefTable& revolute_table() {
  static const DefTable t = [] {
    TableOf<RevoluteDef> table("the bodies turn about a common point");
    drive_rows(joint_rows(table), kTurn).check(check_drive);
    return table.build();
  }();
  return t;
}
const DefTable& prismatic_table() {
  static const DefTable t = [] {
    TableOf<PrismaticDef> table("the bodies slide along an axis of a and do not turn");
    drive_rows(joint_rows(table), kSlide)
        .vector("axis", &PrismaticDef::axis, "1", any(), "direction in the world at t = 0; any length")
        .check([](const PrismaticDef& d, const DefTable::Report& report) {
          check_drive(d, report);
          if (!(norm(d.axis) > 0)) report("/axis", "the axis must not be zero");
        });
    return table.build();
  }();
  return t;
}
const DefTable& wheel_table() {
  static const DefTable t = [] {
    TableOf<WheelDef> table(
        "b turns freely and slides on a sprung axis of a; the motor turns the wheel, limits bound the "
        "suspension");
    std::optional<double> WheelDef::*hertz = &Drive::hertz;
    double WheelDef::*ratio = &Drive::damping_ratio;
    stiffness_rows(motor_rows(limit_rows(joint_rows(table), kSlide), kTurn), kSlide)
        .vector("axis", &WheelDef::axis, "1", any(), "direction of the suspension at t = 0; any length")
        .number(
            "hertz", hertz, "Hz", at_least(0),
            "of the suspension, instead of stiffness; 0: none; absent: 1 Hz without stiffness and damping")
        .also("spring_hertz")
        .number("damping_ratio", ratio, "1", at_least(0), "of a suspension given by hertz")
        .also("spring_damping_ratio")
        .check([](const WheelDef& d, const DefTable::Report& report) {
          check_drive(d, report);
          if (!(norm(d.axis) > 0)) report("/axis", "the axis must not be zero");
        });
    return table.build();
  }();
  return t;
}
const DefTable& distance_table() {
  static const DefTable t = [] {
    TableOf<DistanceDef> table("keeps two points at a distance: a rod, a spring (hertz) or a rope (maximum)");
    joint_rows(table)
        .vector("anchor_b", &DistanceDef::anchor_b, "m", any(),
                "point of b at t = 0, while anchor is that of a; absent: the bodies' centres")
        .number("length", &DistanceDef::length, "m", above(0), "absent: the distance at t = 0")
        .number("minimum", &DistanceDef::minimum, "m", at_least(0),
                "smallest distance; with maximum: free in between")
        .number("maximum", &DistanceDef::maximum, "m", above(0), "largest distance; alone: a rope")
        .number("hertz", &DistanceDef::hertz, "Hz", above(0),
                "a spring: natural frequency of the bodies in their pose at t = 0; absent: rigid")
        .number("damping_ratio", &DistanceDef::damping_ratio, "1", at_least(0), "of the spring")
        .check([](const DistanceDef& d, const DefTable::Report& report) {
          if (d.minimum && d.maximum && *d.minimum > *d.maximum)
            report("/minimum", "minimum must not be above maximum");
        });
    return table.build();
  }();
  return t;
}
const DefTable& spring_table() {
  using D = SpringDef;
  static const DefTable t = [] {
    TableOf<D> table("a damped spring between two points");
    joint_rows(table)
        .vector("anchor_b", &D::anchor_b, "m", any(),
                "point of b at t = 0, while anchor is that of a; absent: the bodies' centres")
        .number("length", &D::length, "m", at_least(0), "rest length; absent: the distance at t = 0")
        .number("stiffness", &D::stiffness, "N/m", at_least(0), "force per length")
        .number("damping", &D::damping, "N s/m", at_least(0), "force per speed")
        .number("hertz", &D::hertz, "Hz", above(0),
                "instead of stiffness: natural frequency of the bodies in their pose at t = 0")
        .number("damping_ratio", &D::damping_ratio, "1", at_least(0), "of a spring given by hertz")
        .check([](const D& d, const DefTable::Report& report) {
          if (d.hertz && (d.stiffness || d.damping)) {
            report("/hertz", "give a spring by hertz and damping_ratio or by stiffness and damping");
          }
          if (!d.hertz && !d.stiffness && !d.damping) {
            report("/stiffness", "a spring needs hertz, stiffness or damping");
          }
        });
    return table.build();
  }();
  return t;
}
const DefTable& weld_table() {
  static const DefTable t = [] {
    TableOf<WeldDef> table("the bodies neither slide nor turn relative to one another");
    joint_rows(table)
        .number("hertz", &WeldDef::hertz, "Hz", above(0), "yields to rotation like a spring; absent: rigid")
        .number("damping_ratio", &WeldDef::damping_ratio, "1", at_least(0), "of that spring");
    return table.build();
  }();
  return t;
}
const DefTable& motor_table() {
  static const DefTable t = [] {
    TableOf<MotorDef> table(
        "drives b to a pose or at a velocity relative to a, with limited force and torque");
    joint_rows(table)
        .vector("move", &MotorDef::move, "m", any(), "added to the position of b at t = 0, in the frame of a")
        .also("offset")
        .number("turn", &MotorDef::turn, "rad", any(), "added to the relative angle at t = 0")
        .also("angle")
        .vector("velocity", &MotorDef::velocity, "m/s", any(), "of b in the frame of a, instead of move")
        .number("angular_velocity", &MotorDef::angular_velocity, "rad/s", any(),
                "of b relative to a, instead of turn")
        .number("rate", &MotorDef::rate, "1/s", above(0), "rate at which the remaining error decays")
        .number("max_force", &MotorDef::max_force, "N", at_least(0), "limit of the force")
        .number("max_torque", &MotorDef::max_torque, "N m", at_least(0), "limit of the torque");
    return table.build();
  }();
  return t;
}
const DefTable& mouse_table() {
  static const DefTable t = [] {
    TableOf<MouseDef> table("pulls a point of b towards a target with a damped spring");
    joint_rows(table)
        .vector("target", &MouseDef::target, "m", any(), "position to which the anchor is pulled")
        .number("hertz", &MouseDef::hertz, "Hz", above(0), "of the spring")
        .number("damping_ratio", &MouseDef::damping_ratio, "1", at_least(0), "of the spring")
        .number("max_force", &MouseDef::max_force, "N", above(0), "bound; absent: none");
    return table.build();
  }();
  return t;
}
const DefTable& gear_table() {
  static const DefTable t = [] {
    TableOf<GearDef> table("couples rotations: angle of a + ratio * angle of b keeps its value at t = 0");
    joint_rows(table).number("ratio", &GearDef::ratio, "1", any(), "radius of b over radius of a; not 0");
    table.check([](const GearDef& d, const DefTable::Report& report) {
      if (d.ratio == 0) report("/ratio", "the ratio must not be 0");
    });
    return table.build();
  }();
  return t;
}
const DefTable& pulley_table() {
  static const DefTable t = [] {
    TableOf<PulleyDef> table("a rope over two fixed wheels: length a + ratio * length b cannot grow");
    joint_rows(table)
        .vector("anchor_b", &PulleyDef::anchor_b, "m", any(),
                "point of b at t = 0, while anchor is that of a; absent: the bodies' centres")
        .vector("ground_a", &PulleyDef::ground_a, "m", any(), "wheel above a")
        .vector("ground_b", &PulleyDef::ground_b, "m", any(), "wheel above b")
        .number("ratio", &PulleyDef::ratio, "1", above(0), "mechanical advantage of a block and tackle");
    return table.build();
  }();
  return t;
}

}  // namespace truestep::rigid2d
