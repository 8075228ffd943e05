#include "engine/systems/rigid2d/joint_tables.h"

namespace truestep::rigid2d {
namespace {

template <class D>
TableOf<D>& joint_rows(TableOf<D>& t) {
  int64_t D::*a = &JointDef::a;
  int64_t D::*b = &JointDef::b;
  Vec3 D::*anchor = &JointDef::anchor;
  std::optional<double> D::*break_force = &JointDef::break_force;
  bool D::*collide = &JointDef::collide;
  return t
      .integer("a", a, between(-1, kMostBodies),
               "first body; listed bodies are numbered before generated ones; -1: the world")
      .integer("b", b, between(-1, kMostBodies), "second body, numbered like a")
      .vector("anchor", anchor, "m", any(), "point in the world at t = 0 (the point of a, if there are two)")
      .number("break_force", break_force, "N", above(0), "force at which it breaks; absent: never")
      .boolean("collide", collide, "whether its bodies collide with one another");
}

template <class D>
TableOf<D>& drive_rows(TableOf<D>& t, const char* unit, const char* rate, const char* force) {
  std::optional<double> D::*lower = &Drive::lower;
  std::optional<double> D::*upper = &Drive::upper;
  std::optional<double> D::*speed = &Drive::motor_speed;
  std::optional<double> D::*strength = &Drive::max_motor;
  std::optional<double> D::*hertz = &Drive::hertz;
  double D::*ratio = &Drive::damping_ratio;
  return t.number("lower", lower, unit, any(), "smallest coordinate, 0 at t = 0")
      .number("upper", upper, unit, any(), "largest coordinate")
      .number("motor_speed", speed, rate, any(), "target speed of the motor; absent: no motor")
      .number("max_motor", strength, force, at_least(0),
              "maximum force or torque of the motor; absent: unlimited")
      .number(
          "hertz", hertz, "Hz", above(0),
          "spring towards coordinate 0: natural frequency of the bodies in their pose at t = 0; absent: none")
      .number("damping_ratio", ratio, "1", at_least(0), "of the spring given by hertz");
}

void check_drive(const Drive& d, const DefTable::Report& report) {
  if (d.lower && d.upper && *d.lower > *d.upper) report("/lower", "lower must not be above upper");
}

}  // namespace

const DefTable& revolute_table() {
  static const DefTable t = [] {
    TableOf<RevoluteDef> table("the bodies turn about a common point");
    drive_rows(joint_rows(table), "rad", "rad/s", "N m").check(check_drive);
    return table.build();
  }();
  return t;
}
const DefTable& prismatic_table() {
  static const DefTable t = [] {
    TableOf<PrismaticDef> table("the bodies slide along an axis of a and do not turn");
    drive_rows(joint_rows(table), "m", "m/s", "N")
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
    drive_rows(joint_rows(table), "m", "rad/s", "N m")
        .vector("axis", &WheelDef::axis, "1", any(), "direction of the suspension at t = 0; any length")
        .number("spring_hertz", &WheelDef::spring_hertz, "Hz", at_least(0), "of the suspension; 0: none")
        .number("spring_damping_ratio", &WheelDef::spring_damping_ratio, "1", at_least(0),
                "of the suspension")
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
        .vector("anchor_b", &DistanceDef::anchor_b, "m", any(), "point of b in the world at t = 0")
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
    TableOf<MotorDef> table("drives b to a position and angle relative to a, with limited force and torque");
    joint_rows(table)
        .vector("offset", &MotorDef::offset, "m", any(),
                "added to the position of b at t = 0, in the frame of a")
        .number("angle", &MotorDef::angle, "rad", any(), "added to the relative angle at t = 0")
        .number("max_force", &MotorDef::max_force, "N", at_least(0), "bound")
        .number("max_torque", &MotorDef::max_torque, "N m", at_least(0), "bound")
        .number("correction", &MotorDef::correction, "1", between(0, 1),
                "fraction of the error removed per step");
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
        .vector("anchor_b", &PulleyDef::anchor_b, "m", any(), "point of b in the world at t = 0")
        .vector("ground_a", &PulleyDef::ground_a, "m", any(), "wheel above a")
        .vector("ground_b", &PulleyDef::ground_b, "m", any(), "wheel above b")
        .number("ratio", &PulleyDef::ratio, "1", above(0), "mechanical advantage of a block and tackle");
    return table.build();
  }();
  return t;
}

}  // namespace truestep::rigid2d
