#include "engine/systems/rigid3d/joints/joint_def.h"

#include <cmath>

namespace truestep::rigid3d {
namespace {

constexpr double kMostBodies = 200'000, kHalfTurn = 3.141592653589793;

const DefTable& common_table() {
  static const DefTable t =
      TableOf<JointDef>("a joint")
          .text("id", &JointDef::id,
                "name; its force, torque and coordinates are observed as joint.ID.force and so on")
          .integer("a", &JointDef::a, between(-1, kMostBodies), "row of the first body; -1: the world")
          .integer("b", &JointDef::b, between(-1, kMostBodies), "row of the second body; -1: the world")
          .vector("anchor", &JointDef::anchor, "m", any(),
                  "point in the world at t = 0; absent: midway between the bodies")
          .number("break_force", &JointDef::break_force, "N", above(0),
                  "force at which it breaks; absent: never")
          .number("break_torque", &JointDef::break_torque, "N m", above(0),
                  "torque at which it breaks; absent: never")
          .boolean("collide", &JointDef::collide, "whether its bodies collide with one another")
          .integer("repeat", &JointDef::repeat, between(1, kMostBodies), "number of joints like this one")
          .integer("step", &JointDef::step, between(1, kMostBodies),
                   "added to rows a and b from one joint to the next; -1 stays")
          .vector("offset", &JointDef::offset, "m", any(), "added to the anchor from one joint to the next")
          .build();
  return t;
}
template <class D>
TableOf<D>& add_common(TableOf<D>& t) {
  return t.template base<JointDef>(common_table());
}

struct DriveUnits {
  const char *at, *rate, *force, *stiffness, *damping;
};
constexpr DriveUnits kSlides{"m", "m/s", "N", "N/m", "N s/m"},
    kTurns{"rad", "rad/s", "N m", "N m/rad", "N m s/rad"};

template <class D>
TableOf<D>& add_drive(TableOf<D>& t, const DriveUnits& unit) {
  std::optional<double> D::*lower = &DriveDef::lower;
  std::optional<double> D::*upper = &DriveDef::upper;
  std::optional<double> D::*stiffness = &DriveDef::stiffness;
  std::optional<double> D::*damping = &DriveDef::damping;
  std::optional<double> D::*hertz = &DriveDef::hertz;
  double D::*ratio = &DriveDef::damping_ratio;
  double D::*rest = &DriveDef::rest;
  std::optional<double> D::*speed = &DriveDef::motor_speed;
  std::optional<double> D::*target = &DriveDef::motor_target;
  std::optional<double> D::*most = &DriveDef::max_motor;
  double D::*servo = &DriveDef::motor_rate;
  return t.number("lower", lower, unit.at, any(), "smallest coordinate, 0 at t = 0; full turns are counted")
      .number("upper", upper, unit.at, any(), "largest coordinate")
      .number("stiffness", stiffness, unit.stiffness, at_least(0),
              "stiffness of a spring towards rest; absent: none")
      .number("damping", damping, unit.damping, at_least(0), "of the spring, or damping alone")
      .number("hertz", hertz, "Hz", above(0),
              "instead of stiffness: natural frequency of the bodies in their pose at t = 0")
      .number("damping_ratio", ratio, "1", at_least(0), "of a spring given by hertz")
      .number("rest", rest, unit.at, any(), "rest position of the spring")
      .number("motor_speed", speed, unit.rate, any(), "target speed of the motor; absent: none")
      .number("motor_target", target, unit.at, any(), "target position of the motor, instead of motor_speed")
      .number("max_motor", most, unit.force, at_least(0),
              "maximum force or torque of the motor; absent: unlimited")
      .number("motor_rate", servo, "1/s", above(0), "rate at which the remaining error decays");
}

/// Reports contradictions between the members of a drive.
void check_row(const DriveDef& d, const std::string& at, const DefTable::Report& report) {
  if (d.lower && d.upper && *d.lower > *d.upper) report(at + "/lower", "lower must not be above upper");
  if (d.hertz && (d.stiffness || d.damping)) {
    report(at + "/hertz", "give a spring by hertz and damping_ratio or by stiffness and damping");
  }
  if (d.motor_speed && d.motor_target) report(at + "/motor_target", "a motor has either a speed or a target");
  if (d.max_motor && !d.motor_speed && !d.motor_target) {
    report(at + "/max_motor", "there is no motor: give motor_speed or motor_target");
  }
}
void check_drive(const std::optional<SlideDriveDef>& d, const char* at, const DefTable::Report& report) {
  if (d) check_row(*d, at, report);
}
void check_drive(const std::optional<TurnDriveDef>& d, const char* at, const DefTable::Report& report) {
  if (d) check_row(*d, at, report);
}
void check_axis(const Vec3& axis, const char* at, const DefTable::Report& report) {
  if (!(norm(axis) > 0)) report(at, "the axis must not be zero");
}

const DefTable& slide_drive_table() {
  static const DefTable t = [] {
    TableOf<SlideDriveDef> table("a translation that is free, limited, sprung or driven");
    return add_drive(table, kSlides).build();
  }();
  return t;
}
const DefTable& turn_drive_table() {
  static const DefTable t = [] {
    TableOf<TurnDriveDef> table("a rotation that is free, limited, sprung or driven");
    return add_drive(table, kTurns).build();
  }();
  return t;
}

const DefTable& ball_table() {
  static const DefTable t = [] {
    TableOf<BallJointDef> table("a point of a stays at a point of b");
    return add_common(table).build();
  }();
  return t;
}
const DefTable& fixed_table() {
  static const DefTable t = [] {
    TableOf<FixedJointDef> table("b neither moves nor turns relative to a");
    return add_common(table).build();
  }();
  return t;
}
const DefTable& hinge_table() {
  static const DefTable t = [] {
    using D = HingeJointDef;
    TableOf<D> table("b turns about an axis of a");
    add_drive(add_common(table), kTurns)
        .vector("axis", &D::axis, "1", any(), "direction at t = 0; any length")
        .check([](const D& d, const DefTable::Report& report) {
          check_axis(d.axis, "/axis", report), check_row(d, "", report);
        });
    return table.build();
  }();
  return t;
}
const DefTable& slider_table() {
  static const DefTable t = [] {
    using D = SliderJointDef;
    TableOf<D> table("b slides along an axis of a without turning");
    add_drive(add_common(table), kSlides)
        .vector("axis", &D::axis, "1", any(), "direction at t = 0; any length")
        .check([](const D& d, const DefTable::Report& report) {
          check_axis(d.axis, "/axis", report), check_row(d, "", report);
        });
    return table.build();
  }();
  return t;
}
const DefTable& cylindrical_table() {
  static const DefTable t = [] {
    using D = CylindricalJointDef;
    TableOf<D> table("b slides along an axis of a and turns about it");
    add_common(table)
        .vector("axis", &D::axis, "1", any(), "direction at t = 0; any length")
        .object("slide", &D::slide, slide_drive_table(), "translation along the axis; absent: free")
        .object("turn", &D::turn, turn_drive_table(), "rotation about the axis; absent: free")
        .check([](const D& d, const DefTable::Report& report) {
          check_axis(d.axis, "/axis", report);
          check_drive(d.slide, "/slide", report), check_drive(d.turn, "/turn", report);
        });
    return table.build();
  }();
  return t;
}
const DefTable& plane_table() {
  static const DefTable t = [] {
    using D = PlaneJointDef;
    TableOf<D> table("a point of b stays in a plane of a; b turns about the plane's normal");
    add_common(table)
        .vector("axis", &D::axis, "1", any(), "normal of the plane at t = 0; any length")
        .check([](const D& d, const DefTable::Report& report) { check_axis(d.axis, "/axis", report); });
    return table.build();
  }();
  return t;
}
const DefTable& distance_table() {
  static const DefTable t = [] {
    using D = DistanceJointDef;
    TableOf<D> table("keeps two points at a distance: a rod, or with bounds a rope");
    add_common(table)
        .vector("anchor_b", &D::anchor_b, "m", any(),
                "point of b at t = 0, while anchor is that of a; absent: the bodies' centres")
        .number("length", &D::length, "m", above(0), "of the rod; absent: the distance at t = 0")
        .number("minimum", &D::minimum, "m", at_least(0), "smallest distance, instead of length")
        .number("maximum", &D::maximum, "m", above(0), "largest distance: a rope")
        .check([](const D& d, const DefTable::Report& report) {
          if (d.minimum && d.maximum && *d.minimum > *d.maximum) {
            report("/minimum", "minimum must not be above maximum");
          }
          if (d.length && (d.minimum || d.maximum)) {
            report("/length", "give either length or minimum and maximum");
          }
        });
    return table.build();
  }();
  return t;
}
const DefTable& spring_table() {
  static const DefTable t = [] {
    using D = SpringJointDef;
    TableOf<D> table("a damped spring between two points");
    add_common(table)
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
const DefTable& universal_table() {
  static const DefTable t = [] {
    using D = UniversalJointDef;
    TableOf<D> table("joins two shafts by a cross: one arm turns in a, the other, at right angles, in b");
    add_common(table)
        .vector("axis", &D::axis, "1", any(), "arm held by a, at t = 0; any length")
        .vector("axis_b", &D::axis_b, "1", any(), "arm held by b, at t = 0; must be at right angles to axis")
        .object("turn", &D::turn, turn_drive_table(), "rotation about axis; absent: free")
        .object("turn_b", &D::turn_b, turn_drive_table(), "rotation about axis_b; absent: free")
        .check([](const D& d, const DefTable::Report& report) {
          check_axis(d.axis, "/axis", report), check_axis(d.axis_b, "/axis_b", report);
          const double lengths = norm(d.axis) * norm(d.axis_b);
          if (lengths > 0 && std::abs(dot(d.axis, d.axis_b)) > 1e-6 * lengths) {
            report("/axis_b", "axis_b must be at right angles to axis");
          }
          check_drive(d.turn, "/turn", report), check_drive(d.turn_b, "/turn_b", report);
        });
    return table.build();
  }();
  return t;
}
const DefTable& cone_twist_table() {
  static const DefTable t = [] {
    using D = ConeTwistJointDef;
    TableOf<D> table("a spherical joint with an axis that stays in a cone, and limited twist");
    add_common(table)
        .vector("axis", &D::axis, "1", any(), "of the cone and of the twist at t = 0; any length")
        .number("swing", &D::swing, "rad", between(0, kHalfTurn),
                "half of the cone's opening angle; absent: free")
        .number("twist_lower", &D::twist_lower, "rad", any(), "smallest twist; absent: free")
        .number("twist_upper", &D::twist_upper, "rad", any(), "largest twist; absent: free")
        .check([](const D& d, const DefTable::Report& report) {
          check_axis(d.axis, "/axis", report);
          if (d.twist_lower && d.twist_upper && *d.twist_lower > *d.twist_upper) {
            report("/twist_lower", "twist_lower must not be above twist_upper");
          }
        });
    return table.build();
  }();
  return t;
}
const DefTable& six_dof_table() {
  static const DefTable t = [] {
    using D = SixDofJointDef;
    TableOf<D> table(
        "translations and rotations along three axes of a: locked if absent, free if {}; of three "
        "free rotations the second is limited to a quarter turn to either side");
    add_common(table)
        .vector("axis", &D::axis, "1", any(), "direction of x at t = 0; any length")
        .vector("across", &D::across, "1", any(),
                "direction of y at t = 0, made perpendicular to x; absent: arbitrary")
        .object("x", &D::x, slide_drive_table(), "translation along x")
        .object("y", &D::y, slide_drive_table(), "translation along y")
        .object("z", &D::z, slide_drive_table(), "translation along z")
        .object("turn_x", &D::turn_x, turn_drive_table(), "first rotation, about x of a")
        .object("turn_y", &D::turn_y, turn_drive_table(), "second rotation, about y")
        .object("turn_z", &D::turn_z, turn_drive_table(), "third rotation, about z of b")
        .check([](const D& d, const DefTable::Report& report) {
          check_axis(d.axis, "/axis", report);
          if (d.across && !(norm(cross(d.axis, *d.across)) > 1e-9 * norm(d.axis) * norm(*d.across))) {
            report("/across", "across must not be zero or parallel to axis");
          }
          check_drive(d.x, "/x", report), check_drive(d.y, "/y", report), check_drive(d.z, "/z", report);
          check_drive(d.turn_x, "/turn_x", report), check_drive(d.turn_y, "/turn_y", report);
          check_drive(d.turn_z, "/turn_z", report);
        });
    return table.build();
  }();
  return t;
}
const DefTable& motor_table() {
  static const DefTable t = [] {
    using D = MotorJointDef;
    TableOf<D> table("drives b to a pose or at a velocity relative to a, with limited force and torque");
    add_common(table)
        .vector("move", &D::move, "m", any(), "added to the position of b at t = 0")
        .vector("turn", &D::turn, "rad", any(), "rotation vector added to the orientation of b at t = 0")
        .vector("velocity", &D::velocity, "m/s", any(), "of b relative to a, instead of move")
        .vector("angular_velocity", &D::angular_velocity, "rad/s", any(),
                "of b relative to a, instead of turn")
        .number("rate", &D::rate, "1/s", above(0), "rate at which the remaining error decays")
        .number("max_force", &D::max_force, "N", at_least(0), "limit of the force")
        .number("max_torque", &D::max_torque, "N m", at_least(0), "limit of the torque")
        .check([](const D& d, const DefTable::Report& report) {
          if (norm(d.turn) > kHalfTurn) report("/turn", "must be at most half a turn");
        });
    return table.build();
  }();
  return t;
}
const DefTable& gear_table() {
  static const DefTable t = [] {
    using D = GearJointDef;
    TableOf<D> table(
        "keeps coordinate of one joint + ratio * coordinate of another: angles of revolute joints, "
        "positions of prismatic ones");
    table.text("id", &D::id, "name; its torque is observed as joint.ID.torque")
        .integer("first", &D::first, between(0, kMostJoints),
                 "row of a revolute or prismatic joint; an entry with repeat has that many rows")
        .integer("second", &D::second, between(0, kMostJoints), "row of the other")
        .number("ratio", &D::ratio, "1", any(),
                "turns of first per turn of second in the opposite direction; m/rad or rad/m for a rack")
        .check([](const D& d, const DefTable::Report& report) {
          if (d.ratio == 0) report("/ratio", "the ratio must not be 0");
          if (d.first == d.second) report("/second", "a gear needs two different joints");
        });
    return table.build();
  }();
  return t;
}

}  // namespace

std::vector<NamedTable> joint_tables() {
  return {{"spherical|ball", &ball_table()},
          {"fixed|weld", &fixed_table()},
          {"revolute|hinge|pin", &hinge_table()},
          {"prismatic|slider", &slider_table()},
          {"cylindrical", &cylindrical_table()},
          {"plane", &plane_table()},
          {"distance", &distance_table()},
          {"spring", &spring_table()},
          {"universal", &universal_table()},
          {"cone_twist", &cone_twist_table()},
          {"six_dof", &six_dof_table()},
          {"motor", &motor_table()},
          {"gear", &gear_table()}};
}

int64_t joint_count(const AnyJointDef& d) {
  return std::visit(
      [](const auto& j) -> int64_t {
        if constexpr (requires { j.repeat; }) return j.repeat;
        return 1;
      },
      d);
}

const std::string& joint_id(const AnyJointDef& d) {
  return std::visit([](const auto& j) -> const std::string& { return j.id; }, d);
}

}  // namespace truestep::rigid3d
