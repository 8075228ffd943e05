// Joints built from their definitions: one visitor gives each kind its rows, locks and drives.
#include <algorithm>
#include <cmath>
#include <set>

#include "engine/base/errors.h"
#include "engine/kernels/rigid/free_rotation.h"
#include "engine/rigid/constraint_colouring.h"
#include "engine/systems/rigid3d/joints/joints.h"

namespace truestep::rigid3d {
namespace {

constexpr double kTurn = 6.283185307179586;

Quat inverse_of(const Quat& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

/// The frame with its first axis along `axis` and its second as close to `across` as possible.
Quat frame(const Vec3& axis, const Vec3& across) {
  const Vec3 x = normalized(axis, {0, 1, 0});
  const Vec3 any = std::abs(x.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 y0 = across - x * dot(x, across);
  const Vec3 y = norm(y0) > 1e-9 * norm(across) ? normalized(y0, any) : normalized(cross(x, any), any);
  const Vec3 z = cross(x, y);
  // Divides by the largest of the four squared components of the quaternion.
  const double w = 1 + x.x + y.y + z.z, i = 1 + x.x - y.y - z.z, j = 1 - x.x + y.y - z.z,
               k = 1 - x.x - y.y + z.z;
  const double most = std::max({w, i, j, k});
  if (most == w) return normalized(Quat{w, y.z - z.y, z.x - x.z, x.y - y.x});
  if (most == i) return normalized(Quat{y.z - z.y, i, y.x + x.y, z.x + x.z});
  if (most == j) return normalized(Quat{z.x - x.z, y.x + x.y, j, z.y + y.z});
  return normalized(Quat{x.y - y.x, z.x + x.z, z.y + y.z, k});
}
Quat frame(const Vec3& axis) {
  return frame(axis, cross(axis, std::abs(axis.x) < 0.7 * norm(axis) ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
}

/// A joint under construction, in the world's frame at t = 0.
struct Making {
  Joint joint;
  Quat slides, turns;            // frames of the rows
  std::optional<Vec3> anchor_b;  // where it differs from that of a
  std::vector<Drive> drives;

  void lock(std::array<uint8_t, 6> rows, Joint::Form form, const Vec3& axis) {
    joint.locked = rows, joint.form = form, slides = turns = frame(axis);
  }
  void drive(uint32_t row, const DriveDef& d) {
    Drive out;
    out.row = row;
    if (d.lower) out.laws |= Drive::kLower, out.lower = *d.lower;
    if (d.upper) out.laws |= Drive::kUpper, out.upper = *d.upper;
    spring(out, d.hertz, d.damping_ratio, d.stiffness, d.damping), out.rest = d.rest;
    if (d.motor_speed || d.motor_target) {
      out.laws |= Drive::kMotor;
      out.wants = d.motor_speed ? Drive::Wants::speed : Drive::Wants::place;
      out.motor_target = d.motor_speed ? *d.motor_speed : *d.motor_target;
      out.servo_rate = d.motor_rate;
      out.max_motor = d.max_motor.value_or(kUnbounded);
    }
    if (out.laws) drives.push_back(out);
  }
  /// Rotations of observed joints are counted beyond half a turn: their free rows are drives without laws.
  void count_turns() {
    if (joint.form != Joint::Form::hinge && joint.form != Joint::Form::cardan) return;
    for (uint32_t row = 3; row < 6; ++row) {
      const bool known =
          std::any_of(drives.begin(), drives.end(), [row](const Drive& d) { return d.row == row; });
      if (joint.locked[row] || known) continue;
      Drive counted;
      counted.row = row;
      drives.push_back(counted);
    }
  }
  static void spring(Drive& out, std::optional<double> hertz, double ratio, std::optional<double> stiffness,
                     std::optional<double> damping) {
    if (hertz) {
      out.laws |= Drive::kSpring;
      out.frequency = kTurn * *hertz, out.damping_ratio = ratio;
    } else if (stiffness || damping) {
      out.laws |= Drive::kSpring;
      out.stiffness = stiffness.value_or(0), out.damping = damping.value_or(0);
    }
  }
  void line(std::optional<Vec3> b, std::optional<double> length) {
    joint.form = Joint::Form::line, slides = turns = Quat{};
    anchor_b = b, joint.length = length.value_or(-1);
  }
};

struct Make {
  Making& m;

  void operator()(const BallJointDef&) const { m.lock({1, 1, 1, 0, 0, 0}, Joint::Form::free, {0, 1, 0}); }
  void operator()(const FixedJointDef&) const { m.lock({1, 1, 1, 1, 1, 1}, Joint::Form::locked, {0, 1, 0}); }
  void operator()(const HingeJointDef& d) const {
    m.lock({1, 1, 1, 0, 1, 1}, Joint::Form::hinge, d.axis), m.drive(3, d);
  }
  void operator()(const SliderJointDef& d) const {
    m.lock({0, 1, 1, 1, 1, 1}, Joint::Form::locked, d.axis), m.drive(0, d);
  }
  void operator()(const CylindricalJointDef& d) const {
    m.lock({0, 1, 1, 0, 1, 1}, Joint::Form::hinge, d.axis);
    if (d.slide) m.drive(0, *d.slide);
    if (d.turn) m.drive(3, *d.turn);
  }
  void operator()(const PlaneJointDef& d) const { m.lock({1, 0, 0, 0, 1, 1}, Joint::Form::hinge, d.axis); }
  void operator()(const DistanceJointDef& d) const {
    m.line(d.anchor_b, d.length);
    if (!d.minimum && !d.maximum) {
      m.joint.locked[0] = 1;
      return;
    }
    // Bounds apply to the whole length.
    m.joint.length = 0;
    DriveDef bounds;
    bounds.lower = d.minimum, bounds.upper = d.maximum;
    m.drive(0, bounds);
  }
  void operator()(const SpringJointDef& d) const {
    m.line(d.anchor_b, d.length);
    DriveDef spring;
    spring.hertz = d.hertz, spring.damping_ratio = d.damping_ratio;
    spring.stiffness = d.stiffness, spring.damping = d.damping;
    m.drive(0, spring);
  }
  void operator()(const UniversalJointDef& d) const {
    // The cross turns about x of a and z of b; the normal of its plane is locked.
    m.lock({1, 1, 1, 0, 1, 0}, Joint::Form::cardan, d.axis);
    m.turns = frame(d.axis, cross(d.axis_b, d.axis));
    if (d.turn) m.drive(3, *d.turn);
    if (d.turn_b) m.drive(5, *d.turn_b);
  }
  void operator()(const ConeTwistJointDef& d) const {
    const bool limited = d.swing || d.twist_lower || d.twist_upper;
    m.lock({1, 1, 1, 0, 0, 0}, limited ? Joint::Form::swing_twist : Joint::Form::free, d.axis);
    DriveDef twist, swing;
    twist.lower = d.twist_lower, twist.upper = d.twist_upper, swing.upper = d.swing;
    m.drive(3, twist), m.drive(4, swing);
  }
  void operator()(const SixDofJointDef& d) const {
    m.slides = m.turns = d.across ? frame(d.axis, *d.across) : frame(d.axis);
    const std::optional<SlideDriveDef>* slide[3] = {&d.x, &d.y, &d.z};
    const std::optional<TurnDriveDef>* turn[3] = {&d.turn_x, &d.turn_y, &d.turn_z};
    std::vector<int> free, locked;
    for (int e = 0; e < 3; ++e) {
      m.joint.locked[static_cast<size_t>(e)] = !*slide[e];
      if (*slide[e]) m.drive(static_cast<uint32_t>(e), **slide[e]);
      (*turn[e] ? free : locked).push_back(e);
    }
    // Order of the rotations: a single free one first, two free ones first and last, as in a cross.
    std::array<int, 3> order{0, 1, 2};
    if (free.size() == 1) order = {free[0], (free[0] + 1) % 3, (free[0] + 2) % 3};
    if (free.size() == 2) order = {free[0], locked[0], free[1]};
    m.joint.form = free.empty()       ? Joint::Form::locked
                   : free.size() == 1 ? Joint::Form::hinge
                                      : Joint::Form::cardan;
    const Rotation r = rotation(m.slides);
    const auto axis = [&r](int e) {
      const auto at = [e](const Vec3& v) { return e == 0 ? v.x : e == 1 ? v.y : v.z; };
      return Vec3{at(r.row[0]), at(r.row[1]), at(r.row[2])};
    };
    // x and z of the rows are the given axes; y, locked where the order is odd, completes the frame.
    m.turns = frame(axis(order[0]), cross(axis(order[2]), axis(order[0])));
    for (size_t e = 0; e < 3; ++e) {
      const auto& drive = *turn[order[e]];
      m.joint.locked[3 + e] = !drive;
      if (drive) m.drive(static_cast<uint32_t>(3 + e), *drive);
    }
    if (free.size() == 3 &&
        std::none_of(m.drives.begin(), m.drives.end(), [](const Drive& x) { return x.row > 2; })) {
      m.joint.form = Joint::Form::free;
    }
  }
  void operator()(const MotorJointDef& d) const {
    m.lock({}, Joint::Form::pose, {1, 0, 0});
    m.slides = m.turns = Quat{};
    const auto three = [&](uint32_t first, const Vec3& place, const std::optional<Vec3>& velocity) {
      const double at[3] = {place.x, place.y, place.z};
      const double v[3] = {velocity ? velocity->x : 0, velocity ? velocity->y : 0,
                           velocity ? velocity->z : 0};
      for (uint32_t e = 0; e < 3; ++e) {
        Drive out;
        out.row = first + e, out.laws = Drive::kMotor;
        out.wants = velocity ? Drive::Wants::speed : Drive::Wants::place;
        out.motor_target = velocity ? v[e] : at[e];
        out.servo_rate = d.rate, out.max_motor = first == 0 ? d.max_force : d.max_torque;
        m.drives.push_back(out);
      }
    };
    three(0, d.move, d.velocity), three(3, d.turn, d.angular_velocity);
  }
  void operator()(const GearJointDef&) const {}
};

class Builder {
 public:
  Builder(const Rigid3dDef& def, const BodyList& bodies) : def_(def), bodies_(bodies) {}
  JointList build() {
    std::set<std::string> ids;
    for (size_t i = 0; i < def_.joints.size(); ++i) {
      const std::string& id = joint_id(def_.joints[i]);
      if (!id.empty() && !ids.insert(id).second)
        report(i, "id", "duplicate_id", "another joint has this id", id, "");
      std::visit([&](const auto& d) { add(i, d); }, def_.joints[i]);
    }
    for (const auto& [entry, row] : gears_) mesh(entry, row);
    if (!issues_.empty())
      throw Error("scene_invalid", "a joint does not connect two bodies", std::move(issues_));
    return std::move(out_);
  }

 private:
  void report(size_t entry, const char* member, const char* code, std::string why, std::string value,
              std::string allowed) {
    issues_.push_back({"/joints/" + std::to_string(entry) + "/" + member, code, std::move(why),
                       std::move(value), std::move(allowed), "", ""});
  }
  bool moved(uint32_t row) const {
    return row != kNoBody && bodies_.kinds[bodies_.starts[row].kind].moved_by_forces();
  }
  Pose start(uint32_t row) const { return row == kNoBody ? Pose{} : bodies_.starts[row].pose; }

  void add(size_t entry, const GearJointDef& d) {
    Joint j;
    j.id = d.id, j.form = Joint::Form::gear, j.bodies = {kNoBody, kNoBody}, j.ratio = d.ratio;
    j.collide = true;
    gears_.push_back({entry, out_.joints.size()});
    out_.joints.push_back(j);
  }

  template <class D>
  void add(size_t entry, const D& d) {
    for (int64_t k = 0; k < d.repeat; ++k) {
      const auto row = [&](int64_t r, const char* member) {
        if (r == -1) return kNoBody;
        const int64_t at = r + k * d.step;
        if (at >= 0 && static_cast<size_t>(at) < bodies_.starts.size()) return static_cast<uint32_t>(at);
        report(entry, member, "out_of_range", "there is no body " + std::to_string(at), std::to_string(at),
               "-1 (the world) to " + std::to_string(bodies_.starts.size() - 1));
        return kNoBody;
      };
      const size_t before = issues_.size();
      const std::array<uint32_t, 2> rows{row(d.a, "a"), row(d.b, "b")};
      if (issues_.size() > before) return;
      if (rows[0] == rows[1]) return report(entry, "b", "same_body", "a joint needs two bodies", "", "");
      Making m;
      m.joint.bodies = rows;
      std::visit(Make{m}, AnyJointDef(d));
      place(m, d, static_cast<double>(k));
      m.joint.id = k == 0 ? d.id : d.id.empty() ? "" : d.id + "." + std::to_string(k);
      m.joint.break_force = d.break_force.value_or(kUnbounded);
      m.joint.break_torque = d.break_torque.value_or(kUnbounded);
      m.joint.collide = d.collide;
      m.joint.springs_only =
          !m.drives.empty() &&
          std::all_of(m.drives.begin(), m.drives.end(),
                      [](const Drive& x) { return x.laws == Drive::kSpring; }) &&
          std::none_of(m.joint.locked.begin(), m.joint.locked.end(), [](uint8_t l) { return l != 0; });
      if (!m.joint.id.empty()) m.count_turns();
      m.joint.first_drive = static_cast<uint32_t>(out_.drives.size());
      m.joint.drives = static_cast<uint32_t>(m.drives.size());
      for (Drive& drive : m.drives) {
        drive.joint = static_cast<uint32_t>(out_.joints.size());
        out_.drives.push_back(drive);
      }
      out_.joints.push_back(m.joint);
    }
  }

  /// Anchors and frames in the bodies' own frames.
  void place(Making& m, const JointDef& d, double copy) const {
    Joint& j = m.joint;
    const Pose a = start(j.bodies[0]), b = start(j.bodies[1]);
    const bool line = j.form == Joint::Form::line;
    Vec3 anchor = (a.position + b.position) * 0.5;
    if (j.bodies[0] == kNoBody) anchor = b.position;
    if (j.bodies[1] == kNoBody || line) anchor = a.position;
    if (j.form == Joint::Form::pose) anchor = b.position;
    if (d.anchor) anchor = *d.anchor + d.offset * copy;
    Vec3 other = anchor;
    if (line) other = m.anchor_b ? *m.anchor_b + d.offset * copy : b.position;
    j.anchor_a = transform_of(a).inverse_point(anchor), j.anchor_b = transform_of(b).inverse_point(other);
    if (line && j.length < 0) j.length = norm(other - anchor);
    j.slide_frame = normalized(inverse_of(a.orientation) * m.slides);
    j.turn_a = normalized(inverse_of(a.orientation) * m.turns);
    j.turn_b = normalized(inverse_of(b.orientation) * m.turns);
  }

  /// The joints of a gear, and the bodies that it wakes together.
  void mesh(size_t entry, size_t row) {
    const auto& d = std::get<GearJointDef>(def_.joints[entry]);
    const std::pair<const char*, int64_t> ends[2] = {{"first", d.first}, {"second", d.second}};
    for (size_t e = 0; e < 2; ++e) {
      const auto [member, at] = ends[e];
      if (static_cast<size_t>(at) >= out_.joints.size()) {
        return report(entry, member, "out_of_range", "there is no joint " + std::to_string(at),
                      std::to_string(at), "0 to " + std::to_string(out_.joints.size() - 1));
      }
      Joint& j = out_.joints[static_cast<size_t>(at)];
      const bool turns = j.form == Joint::Form::hinge && !j.locked[3] && j.locked[0];
      const bool slides = j.form == Joint::Form::locked && !j.locked[0] && j.locked[1] && j.locked[2];
      if (!turns && !slides) {
        return report(entry, member, "wrong_joint", "a gear couples revolute and prismatic joints",
                      std::to_string(at), "row of a revolute or prismatic joint");
      }
      out_.joints[row].geared[e] = coordinate(static_cast<uint32_t>(at), turns ? 3 : 0);
      out_.joints[row].bodies[e] = moved(j.bodies[1]) ? j.bodies[1] : j.bodies[0];
    }
  }

  /// The drive of a joint's row; a drive without laws if the row has none.
  uint32_t coordinate(uint32_t joint, uint32_t row) {
    Joint& j = out_.joints[joint];
    for (uint32_t k = j.first_drive; k < j.first_drive + j.drives; ++k) {
      if (out_.drives[k].row == row) return k;
    }
    // Drives of a joint are consecutive; joints with this one free row have none before it.
    Drive d;
    d.joint = joint, d.row = row;
    j.first_drive = static_cast<uint32_t>(out_.drives.size()), j.drives = 1;
    out_.drives.push_back(d);
    return j.first_drive;
  }

  const Rigid3dDef& def_;
  const BodyList& bodies_;
  JointList out_;
  std::vector<Issue> issues_;
  std::vector<std::pair<size_t, size_t>> gears_;  // entry, row
};

}  // namespace

JointList build_joints(const Rigid3dDef& def, const BodyList& bodies) {
  JointList joints = Builder(def, bodies).build();
  stiffen_by_frequency(joints, bodies);
  return joints;
}

}  // namespace truestep::rigid3d
