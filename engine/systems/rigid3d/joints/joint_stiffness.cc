// Springs given by frequency: the stiffness that gives the joint's two bodies this frequency in their pose at
// t = 0,  k = m_eff (2 pi f)^2,  c = 2 zeta m_eff 2 pi f,  with m_eff the effective mass of the row
// (joint_drives3.h). It stays constant while the bodies turn: with a stiffness that followed the effective
// mass, the spring would have no energy to conserve.
#include <cmath>

#include "engine/kernels/rigid/joint_drives3.h"
#include "engine/rigid/lanes.h"
#include "engine/systems/rigid3d/joints/joints.h"

namespace truestep::rigid3d {
namespace {

/// Speed of each driven row of the joint per unit impulse on it, 1/kg or 1/(kg m^2).
std::array<double, 6> row_mobility(const Joint& joint, const BodyList& bodies) {
  using W = Wide<double>;
  JointGroup<double> g{};
  const auto pose = [&](uint32_t i) { return i == kNoBody ? Pose{} : bodies.starts[i].pose; };
  const auto body = [&](uint32_t i, uint32_t& record, W& root, W turn[9]) {
    if (i == kNoBody) return;
    const BodyKind& kind = bodies.kinds[bodies.starts[i].kind];
    if (!kind.moved_by_forces()) return;
    const ScaledBody scaled = scaled_body(kind, rotation(pose(i).orientation));
    root.set(0, scaled.root), record = 0;
    for (int e = 0; e < 9; ++e) turn[e].set(0, scaled.turn[e]);
  };
  body(joint.bodies[0], g.a[0], g.root_a, g.turn_a), body(joint.bodies[1], g.b[0], g.root_b, g.turn_b);
  const JointPlace at = joint_place(joint, pose(joint.bodies[0]), pose(joint.bodies[1]));
  set3(g.arm_a, 0, at.arm_a), set3(g.arm_b, 0, at.arm_b), set3(g.error, 0, at.gap);
  for (int e = 0; e < 3; ++e) set3(g.axis[e], 0, at.axes[e]), set3(g.turn_axis[e], 0, at.turns[e]);
  for (size_t e = 0; e < 6; ++e) g.locked[e].set(0, joint.locked[e]);
  if (joint.form == Joint::Form::line) g.flags |= JointGroup<double>::kLines, g.along.set(0, 1);
  g.flags |= JointGroup<double>::kTurns;
  const Record8<double> still{};
  prepare_joints(g, &still, 0.0);
  std::array<double, 6> mobility{};
  for (int row = 0; row < 6; ++row) {
    JointDrive<double> d{};
    d.row = row;
    prepare_drive(g, d);
    mobility[static_cast<size_t>(row)] = d.inverse_k[0] > 0 ? d.k[0] : 0;
  }
  return mobility;
}

}  // namespace

void stiffen_by_frequency(JointList& joints, const BodyList& bodies) {
  for (const Joint& joint : joints.joints) {
    std::array<double, 6> mobility{};
    bool known = false;
    for (uint32_t i = joint.first_drive; i < joint.first_drive + joint.drives; ++i) {
      Drive& d = joints.drives[i];
      if (!(d.frequency > 0)) continue;
      if (!known) mobility = row_mobility(joint, bodies), known = true;
      const double k = mobility[d.row], mass = k > 0 ? 1 / k : 0;
      d.stiffness = mass * d.frequency * d.frequency, d.damping = 2 * d.damping_ratio * mass * d.frequency;
    }
  }
}

}  // namespace truestep::rigid3d
