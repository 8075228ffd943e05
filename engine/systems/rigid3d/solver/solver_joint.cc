#include "engine/systems/rigid3d/solver/solver_joint.h"

#include <algorithm>
#include <bit>

#include "engine/kernels/rigid/soft_constraint.h"

namespace truestep::rigid3d {

namespace {
/// Rate of joint springs as a fraction of the substeps' rate, and their damping ratio.
constexpr double kJointHertzShare = 0.25, kJointDamping = 2;
}  // namespace

template <class T>
void JointSolver<T>::choose(const State& s, std::span<const BodyNow> now, std::span<uint32_t> slot) {
  const auto bodies = s.span<uint32_t>(columns::joint_bodies);
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  const auto active = [&](uint32_t i) { return i != kNoBody && now[i].part == BodyNow::Part::active; };
  listed_.clear();
  for (uint32_t k = 0; k < broken.size(); ++k) {
    const uint32_t a = bodies[2 * k], b = bodies[2 * k + 1];
    if (broken[k] || (!active(a) && !active(b))) continue;
    if (active(a)) slot[a] = 0;
    if (active(b)) slot[b] = 0;
    listed_.push_back(k);
  }
}

template <class T>
void JointSolver<T>::fill(const State& s, const JointList& joints, const Bodies& bodies, double h,
                          const ThreadTeam& team) {
  end_ = static_cast<uint32_t>(bodies.moving);
  ends_.clear();
  std::erase_if(listed_, [&](uint32_t k) { return joints.joints[k].form == Joint::Form::gear; });
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const auto slot = [&](uint32_t i) { return i == kNoBody ? kNoBody : bodies.slot[i]; };
  for (const uint32_t k : listed_) ends_.push_back({slot(held[2 * k]), slot(held[2 * k + 1])});
  make_lanes(listed_, ends_, {}, bodies.moving, W::kLanes, colouring_, lanes_);
  if (groups_.size() < lanes_.count) groups_.resize(lanes_.count);
  count_drives(joints);
  team.for_blocks(lanes_.count, kGroupsPerBlock, [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g) fill_group(g, s, joints, bodies, h);
  });
  fill_gears(s, joints);
}

/// Allocates the drives of every group, one for each row that any of its lanes drives.
template <class T>
void JointSolver<T>::count_drives(const JointList& joints) {
  uint32_t total = 0;
  coordinate_.resize(joints.drives.size());
  for (size_t g = 0; g < lanes_.count; ++g) {
    uint32_t rows = 0;
    for (int lane = 0; lane < W::kLanes && !joints.drives.empty(); ++lane) {
      const uint32_t k = lanes_.member[g * W::kLanes + static_cast<size_t>(lane)];
      if (k == kNoBody) continue;
      const Joint& j = joints.joints[k];
      for (uint32_t d = j.first_drive; d < j.first_drive + j.drives; ++d) rows |= 1u << joints.drives[d].row;
    }
    groups_[g].driven_rows = rows, groups_[g].first_drive = total;
    groups_[g].drives = static_cast<uint32_t>(std::popcount(rows));
    total += groups_[g].drives;
  }
  if (drives_.size() < total) drives_.resize(total);
}

template <class T>
void JointSolver<T>::fill_group(size_t group, const State& s, const JointList& joints, const Bodies& bodies,
                                double h) {
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  JointGroup<T>& g = groups_[group];
  const uint32_t rows = g.driven_rows, first = g.first_drive, drives = g.drives;
  g = JointGroup<T>{};
  g.driven_rows = rows, g.first_drive = first, g.drives = drives;
  for (uint32_t row = 0, k = 0; row < 6; ++row) {
    if (!(g.driven_rows >> row & 1)) continue;
    JointDrive<T>& d = drives_[g.first_drive + k++];
    d = JointDrive<T>{};
    d.row = static_cast<int>(row);
    d.lower.error = d.upper.error = W(JointDrive<T>::kFar);
  }
  g.bound[0] = g.bound[1] = W(kAnyImpulse);
  constexpr uint32_t kAngularRows = 0b111000;
  if (rows & kAngularRows) g.flags |= JointGroup<T>::kTurns;
  for (int lane = 0; lane < W::kLanes; ++lane) {
    const uint32_t k = lanes_.member[group * W::kLanes + static_cast<size_t>(lane)];
    g.a[lane] = g.b[lane] = end_;
    if (k == kNoBody) continue;
    const Joint& joint = joints.joints[k];
    const uint32_t a = held[2 * k], b = held[2 * k + 1];
    const auto pose = [&](uint32_t i) { return i == kNoBody ? Pose{} : Pose{load3(x, i), load_quat(q, i)}; };
    const JointPlace at = joint_place(joint, pose(a), pose(b));
    bool rotates = false;
    const auto body = [&](uint32_t i, uint32_t* slot, W& root, W turn[9]) {
      if (i == kNoBody || bodies.slot[i] == kNoBody) return;
      const ScaledBody& scaled = bodies.scaled[bodies.slot[i]];
      rotates |= scaled.rotates();
      slot[lane] = bodies.slot[i], root.set(lane, T(scaled.root));
      for (int e = 0; e < 9; ++e) turn[e].set(lane, T(scaled.turn[e]));
    };
    body(a, g.a, g.root_a, g.turn_a), body(b, g.b, g.root_b, g.turn_b);
    set3(g.arm_a, lane, at.arm_a), set3(g.arm_b, lane, at.arm_b), set3(g.error, lane, at.gap);
    for (size_t e = 0; e < 3; ++e) {
      set3(g.axis[e], lane, at.axes[e]), set3(g.turn_axis[e], lane, at.turns[e]);
      if (joint.locked[3 + e]) g.angle[e].set(lane, T(at.coordinate[3 + e]));
    }
    for (size_t e = 0; e < 6; ++e) {
      // Between bodies that never rotate, rotations need no rows, and would have no inverse.
      g.locked[e].set(lane, T(e < 3 || rotates ? joint.locked[e] : 0));
      g.impulse[e].set(lane, T(s.f64(columns::joint_impulse)[6 * k + e]));
    }
    if (joint.locked[3] || joint.locked[4] || joint.locked[5]) g.flags |= JointGroup<T>::kTurns;
    if (joint.form == Joint::Form::line) {
      g.flags |= JointGroup<T>::kLines;
      g.along.set(lane, 1), g.length.set(lane, T(joint.length));
    }
    if (joint.form == Joint::Form::pose) {
      g.flags |= JointGroup<T>::kBounded;
      for (size_t e = 0; e < 2; ++e) {
        const double most = s.f64(columns::drive_motor)[2 * (joint.first_drive + 3 * e) + 1];
        g.bound[e].set(lane, T(std::min(most, kAnyImpulse)));
      }
    }
    set_drift(g, lane, s, {a, b}, bodies, at);
    for (uint32_t d = joint.first_drive; d < joint.first_drive + joint.drives; ++d) {
      fill_drive(g, lane, s, joint, d, joints.drives[d], at);
    }
  }
}

/// Contribution of kinematic bodies to J v.
template <class T>
void JointSolver<T>::set_drift(JointGroup<T>& g, int lane, const State& s,
                               const std::array<uint32_t, 2>& held, const Bodies& bodies,
                               const JointPlace& at) {
  for (size_t end = 0; end < 2; ++end) {
    const uint32_t i = held[end];
    if (i == kNoBody || bodies.now[i].part != BodyNow::Part::kinematic) continue;
    const double sign = end == 0 ? -1 : 1;
    const Vec3 w = load3(s.f64(columns::angular_velocity).data(), i);
    const Vec3 arm = end == 0 ? at.arm_a + at.gap : at.arm_b;
    const Vec3 v = load3(s.f64(columns::velocity).data(), i) + cross(w, arm);
    g.flags |= JointGroup<T>::kDrifts;
    for (int e = 0; e < 3; ++e) {
      g.drift[e].set(lane, T(g.drift[e][lane] + sign * dot(at.axes[e], v)));
      g.drift[3 + e].set(lane, T(g.drift[3 + e][lane] + sign * dot(at.turns[e], w)));
    }
  }
}

template <class T>
void JointSolver<T>::fill_drive(JointGroup<T>& g, int lane, const State& s, const Joint& joint,
                                uint32_t index, const Drive& drive, const JointPlace& at) {
  JointDrive<T>& d = drive_of(g, drive.row);
  double coordinate = at.coordinate[drive.row];
  if (drive.row >= 3 && joint.form != Joint::Form::pose) {
    coordinate = unwrapped(coordinate, s.f64(columns::drive_coordinate)[index]);
  }
  coordinate_[index] = coordinate;
  const double* impulse = s.f64(columns::drive_impulse).data() + 4 * static_cast<size_t>(index);
  const double* motor = s.f64(columns::drive_motor).data() + 2 * static_cast<size_t>(index);
  d.laws |= drive.laws;
  // Row 0 of a line is measured from the target length.
  d.start.set(lane, drive.row < 3 ? T(at.coordinate[drive.row]) : T(0));
  if (drive.laws & Drive::kSpring) {
    g.flags |= JointGroup<T>::kSprings;
    d.spring.error.set(lane, T(coordinate - drive.rest)), d.spring.impulse.set(lane, T(impulse[0]));
    d.spring.most.set(lane, T(kAnyImpulse));
  }
  if (drive.laws & Drive::kMotor) {
    if (drive.wants == Drive::Wants::speed) {
      d.motor.speed.set(lane, T(motor[0])), d.motor.scale.set(lane, T(1));
    } else {
      const double low = drive.laws & Drive::kLower ? drive.lower : -kUnbounded;
      const double high = drive.laws & Drive::kUpper ? drive.upper : kUnbounded;
      d.motor.error.set(lane, T(coordinate - std::max(low, std::min(high, motor[0]))));
    }
    // The rows of a pose are limited together.
    const double most = joint.form == Joint::Form::pose ? kAnyImpulse : std::min(motor[1], kAnyImpulse);
    d.motor.most.set(lane, T(most)), d.motor.impulse.set(lane, T(impulse[1]));
  }
  if (drive.laws & Drive::kLower) {
    d.lower.error.set(lane, T(coordinate - drive.lower)), d.lower.impulse.set(lane, T(impulse[2]));
  }
  if (drive.laws & Drive::kUpper) {
    d.upper.error.set(lane, T(drive.upper - coordinate)), d.upper.impulse.set(lane, T(impulse[3]));
  }
}

/// Indices of this step's joints, and the gears both of whose joints are among them.
template <class T>
void JointSolver<T>::fill_gears(const State& s, const JointList& joints) {
  gears_.clear();
  const auto& all = joints.joints;
  if (std::none_of(all.begin(), all.end(), [](const Joint& j) { return j.form == Joint::Form::gear; }))
    return;
  place_.assign(all.size(), kNoBody);
  for (uint32_t k = 0; k < lanes_.member.size(); ++k) {
    if (lanes_.member[k] != kNoBody) place_[lanes_.member[k]] = k;
  }
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  for (uint32_t k = 0; k < all.size(); ++k) {
    if (all[k].form != Joint::Form::gear || broken[k]) continue;
    GearRow<T> gear;
    gear.joint = k, gear.ratio = T(all[k].ratio);
    gear.impulse = T(s.f64(columns::joint_impulse)[6 * k]);
    double error = 0;
    bool here = true;
    for (size_t m = 0; m < 2; ++m) {
      const uint32_t index = all[k].geared[m];
      const Drive& drive = joints.drives[index];
      const uint32_t at = place_[drive.joint];
      here &= at != kNoBody;
      if (!here) break;
      error += (m == 0 ? 1 : all[k].ratio) * coordinate_[index];
      const uint32_t group = at / W::kLanes;
      const auto place = static_cast<uint32_t>(&drive_of(groups_[group], drive.row) - drives_.data());
      gear.mesh[m] = {group, place, static_cast<int>(at % W::kLanes)};
    }
    gear.error = T(error);
    if (here) gears_.push_back(gear);
  }
}

template <class T>
void JointSolver<T>::prepare(JointGroup<T>& g, const Record8<T>* moved, double elapsed) {
  prepare_joints(g, moved, T(elapsed));
  for (uint32_t k = 0; k < g.drives; ++k) prepare_drive(g, drives_[g.first_drive + k]);
}

template <class T>
SoftConstraint<double> JointSolver<T>::softness(double h) {
  return soft_constraint<double>(kJointHertzShare / h, kJointDamping, h);
}

template <class T>
void JointSolver<T>::start(const JointList& joints, const Record8<T>* moved, Record8<T>* warm, double h,
                           const ThreadTeam& team) {
  const auto soft = softness(h);
  pass_ = {T(soft.bias_rate), T(soft.mass_scale), T(soft.impulse_scale), T(1 / h)};
  relax_.inverse_h = T(1 / h);
  each_colour(lanes_, groups_, team, [&](JointGroup<T>& g) {
    prepare(g, moved, 0);
    soften(static_cast<size_t>(&g - groups_.data()), joints, h);
    apply_joints(g, drives_.data() + g.first_drive, warm, end_, T(1));
  });
  for (GearRow<T>& gear : gears_) {
    prepare_gear<T>(gear, groups_, drives_, end_);
    apply_gear(gear, warm, end_, T(1));
  }
}

template <class T>
void JointSolver<T>::renew(const Record8<T>* moved, Record8<T>* warm, double elapsed, Renewal renewal,
                           const ThreadTeam& team) {
  const bool last = renewal == Renewal::last;
  for (const GearRow<T>& gear : gears_) apply_gear(gear, warm, end_, T(-1));
  each_colour(lanes_, groups_, team, [&](JointGroup<T>& g) {
    const JointDrive<T>* drives = drives_.data() + g.first_drive;
    if (!last) apply_joints(g, drives, warm, end_, T(-1));
    prepare(g, moved, elapsed);
    if (!last) apply_joints(g, drives, warm, end_, T(1));
  });
  for (GearRow<T>& gear : gears_) {
    prepare_gear<T>(gear, groups_, drives_, end_);
    apply_gear(gear, warm, end_, T(1));
  }
}

template <class T>
void JointSolver<T>::pull(Record8<T>* v, const ThreadTeam& team) {
  each_colour(lanes_, groups_, team, [&](JointGroup<T>& g) {
    if (g.flags & JointGroup<T>::kSprings) pull_springs(g, drives_.data() + g.first_drive, v, end_);
  });
}

template <class T>
void JointSolver<T>::bias(Record8<T>* v, const ThreadTeam& team) {
  each_colour(lanes_, groups_, team, [&](JointGroup<T>& g) {
    solve_joints<ContactSolve::bias>(g, drives_.data() + g.first_drive, v, end_, pass_);
  });
  for (GearRow<T>& gear : gears_) solve_gear<ContactSolve::bias>(gear, v, end_, pass_);
}

template <class T>
void JointSolver<T>::relax(Record8<T>* v, const ThreadTeam& team) {
  each_colour(lanes_, groups_, team, [&](JointGroup<T>& g) {
    solve_joints<ContactSolve::relax>(g, drives_.data() + g.first_drive, v, end_, relax_);
  });
  for (GearRow<T>& gear : gears_) solve_gear<ContactSolve::relax>(gear, v, end_, relax_);
}

template <class T>
void JointSolver<T>::store(State& s, const JointList& joints, double h) {
  const auto impulse = s.f64(columns::joint_impulse), load = s.f64(columns::joint_load);
  const auto held = s.span<uint32_t>(columns::joint_bodies), broken = s.span<uint32_t>(columns::joint_broken);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  const auto pose = [&](uint32_t i) { return i == kNoBody ? Pose{} : Pose{load3(x, i), load_quat(q, i)}; };
  const auto carry = [&](uint32_t k, const Vec3& force, const Vec3& torque) {
    store3(load.data(), 2 * k, force), store3(load.data(), 2 * k + 1, torque);
    const Joint& j = joints.joints[k];
    if (norm(force) > j.break_force || norm(torque) > j.break_torque) broken[k] = 1;
  };
  for (const GearRow<T>& gear : gears_) {
    impulse[6 * gear.joint] = gear.impulse;
    const auto& [group, drive, lane] = gear.mesh[0];
    const int row = drives_[drive].row;
    const JointGroup<T>& g = groups_[group];
    const auto* axis = row < 3 ? g.now[row] : g.turn_now[row - 3];
    const Vec3 made = Vec3{axis[0][lane], axis[1][lane], axis[2][lane]} * (gear.impulse / h);
    carry(gear.joint, row < 3 ? made : Vec3{}, row < 3 ? Vec3{} : made);
  }
  for (size_t group = 0; group < lanes_.count; ++group) {
    JointGroup<T>& g = groups_[group];
    W total[6];
    for (int e = 0; e < 6; ++e) total[e] = g.impulse[e];
    for (uint32_t d = g.first_drive; d < g.first_drive + g.drives; ++d) {
      const W made = detail::total_impulse(drives_[d]);
      for (int e = 0; e < 6; ++e) total[e] = madd(made, drives_[d].share[e], total[e]);
    }
    for (int lane = 0; lane < W::kLanes; ++lane) {
      const uint32_t k = lanes_.member[group * W::kLanes + static_cast<size_t>(lane)];
      if (k == kNoBody) continue;
      const Joint& joint = joints.joints[k];
      Vec3 force, torque;
      for (int e = 0; e < 6; ++e) impulse[6 * k + static_cast<size_t>(e)] = g.impulse[e][lane];
      for (int e = 0; e < 3; ++e) {
        force += Vec3{g.now[e][0][lane], g.now[e][1][lane], g.now[e][2][lane]} * double(total[e][lane]);
        torque += Vec3{g.turn_now[e][0][lane], g.turn_now[e][1][lane], g.turn_now[e][2][lane]} *
                  double(total[3 + e][lane]);
      }
      carry(k, force / h, torque / h);
      if (joint.drives == 0) continue;
      const JointPlace at = joint_place(joint, pose(held[2 * k]), pose(held[2 * k + 1]));
      for (uint32_t i = joint.first_drive; i < joint.first_drive + joint.drives; ++i) {
        const uint32_t row = joints.drives[i].row;
        const JointDrive<T>& d = drive_of(g, row);
        double coordinate = at.coordinate[row];
        if (row >= 3 && joint.form != Joint::Form::pose) {
          coordinate = unwrapped(coordinate, coordinate_[i] + double(g.gap[row][lane] - d.start[lane]));
        }
        s.f64(columns::drive_coordinate)[i] = coordinate;
        double* kept = s.f64(columns::drive_impulse).data() + 4 * static_cast<size_t>(i);
        kept[0] = d.spring.impulse[lane], kept[1] = d.motor.impulse[lane];
        kept[2] = d.lower.impulse[lane], kept[3] = d.upper.impulse[lane];
      }
    }
  }
}

template class JointSolver<float>;
template class JointSolver<double>;

}  // namespace truestep::rigid3d
