#include "engine/systems/rigid3d/joints.h"

#include <cmath>

#include "engine/base/errors.h"
#include "engine/kernels/constraint_colouring.h"
#include "engine/kernels/free_rotation.h"

namespace truestep {
namespace {

Quat conjugate(const Quat& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

std::array<uint8_t, 6> locks(JointDef::Type type) {
  switch (type) {
    case JointDef::Type::ball:
      return {1, 1, 1, 0, 0, 0};
    case JointDef::Type::fixed:
      return {1, 1, 1, 1, 1, 1};
    case JointDef::Type::hinge:
      return {1, 1, 1, 0, 1, 1};
    case JointDef::Type::slider:
      return {0, 1, 1, 1, 1, 1};
    case JointDef::Type::cylindrical:
      return {0, 1, 1, 0, 1, 1};
    case JointDef::Type::plane:
      return {1, 0, 0, 0, 1, 1};
  }
  return {};
}

Pose start_pose(const BodyList& bodies, uint32_t row) {
  return row == kNoBody ? Pose{} : bodies.starts[row].pose;
}

}  // namespace

std::vector<Joint> build_joints(const Rigid3dDef& def, const BodyList& bodies) {
  std::vector<Joint> out;
  std::vector<Issue> issues;
  for (size_t i = 0; i < def.joints.size(); ++i) {
    const JointDef& d = def.joints[i];
    for (int64_t k = 0; k < d.repeat; ++k) {
      const auto row = [&](int64_t r, const char* member) {
        if (r == -1) return kNoBody;
        const int64_t at = r + k * d.step;
        if (at >= 0 && static_cast<size_t>(at) < bodies.starts.size()) return static_cast<uint32_t>(at);
        const std::string why = "there is no body " + std::to_string(at);
        issues.push_back({"/joints/" + std::to_string(i) + "/" + member, "out_of_range", why,
                          std::to_string(at), "-1 (the world) to " + std::to_string(bodies.starts.size() - 1),
                          "", ""});
        return kNoBody;
      };
      Joint j;
      j.bodies = {row(d.a, "a"), row(d.b, "b")};
      if (!issues.empty()) break;
      if (j.bodies[0] == j.bodies[1]) {
        issues.push_back(
            {"/joints/" + std::to_string(i) + "/b", "same_body", "a joint needs two bodies", "", "", "", ""});
        break;
      }
      const Pose a = start_pose(bodies, j.bodies[0]), b = start_pose(bodies, j.bodies[1]);
      Vec3 anchor = (a.position + b.position) * 0.5;
      if (j.bodies[0] == kNoBody) anchor = b.position;
      if (j.bodies[1] == kNoBody) anchor = a.position;
      if (d.anchor) anchor = *d.anchor + d.offset * static_cast<double>(k);
      const Transform ta = transform_of(a), tb = transform_of(b);
      j.anchor_a = ta.inverse_point(anchor), j.anchor_b = tb.inverse_point(anchor);
      const Vec3 axis = normalized(d.axis, {0, 1, 0});
      const Vec3 across =
          normalized(cross(axis, std::abs(axis.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}), {0, 0, 1});
      const Vec3 world[3] = {axis, across, cross(axis, across)};
      for (int e = 0; e < 3; ++e) j.axes[e] = ta.inverse_direction(world[e]);
      j.axis_b = tb.inverse_direction(axis);
      j.turn = conjugate(a.orientation) * b.orientation;
      j.locked = locks(d.type);
      j.turns = j.locked[3] ? Joint::Turns::none : j.locked[4] ? Joint::Turns::about_axis : Joint::Turns::any;
      if (d.break_force) j.break_force = *d.break_force;
      j.touch = d.touch;
      out.push_back(j);
    }
  }
  if (!issues.empty()) throw Error("scene_invalid", "a joint holds no two bodies", std::move(issues));
  return out;
}

JointPlace joint_place(const Joint& joint, const Pose& a, const Pose& b) {
  const Rotation ra = rotation(a.orientation), rb = rotation(b.orientation);
  JointPlace p;
  p.arm_a = ra.apply(joint.anchor_a), p.arm_b = rb.apply(joint.anchor_b);
  p.gap = (b.position - a.position) + (p.arm_b - p.arm_a);
  for (int e = 0; e < 3; ++e) p.axes[e] = ra.apply(joint.axes[e]);
  if (joint.turns == Joint::Turns::none) {
    p.turn = free_rotation::rotation_vector(b.orientation * conjugate(a.orientation * joint.turn));
  } else if (joint.turns == Joint::Turns::about_axis) {
    p.turn = cross(p.axes[0], rb.apply(joint.axis_b));
  }
  return p;
}

}  // namespace truestep
