// A step: recorded and given motion, feet that stay, goals that hands reach, bones and skin that follow.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/systems/skeleton/scratch.h"

namespace truestep::skeleton {

using namespace animation;
using C = SkeletonColumns;

namespace {

constexpr MovedBodies kMovedBones = MovedBodies::from(0);
constexpr size_t kBlock = 512;  // vertices

}  // namespace

void Skeleton::update(State& s, double t, double h, Scratch& scratch) const {
  drive(s, t, scratch);
  if (clip_.feet() > 0) hold_feet(s, t, scratch);
  reach(s, scratch);
  write(s, h, scratch);
  if (!model_.skin.empty()) cover(s, h, scratch);
}

void Skeleton::drive(const State& s, double t, Scratch& scratch) const {
  drive_at(s, own_time(s, t), scratch);
  if (const double* lead = lead_rows(s)) scratch.root = read_pose(lead + LeadRows::placement) * scratch.root;
}

void Skeleton::drive_at(const State& s, double t, Scratch& scratch) const {
  const auto out = driver_.evaluate(t, s.f64(C::kControl), scratch.driver);
  scratch.motion.resize(model_.joints.size());
  const double* c = s.f64(C::kCoordinates).data();
  for (size_t j = 0; j < model_.joints.size(); ++j) scratch.motion[j] = read_motion(c + 8 * j);
  // Shifts come from recorded motion, or from bodies that led it here.
  if (lead_rows(s)) {
    for (JointMotion& m : scratch.motion) m.shift = {};
  }
  if (file_) clip_.pose(t, scratch.motion);
  for (const Layer& l : layers_) l.clip.blend(t, std::clamp(out[l.weight], 0.0, 1.0), l.mode, scratch.motion);
  for (size_t j = 0; j < model_.joints.size(); ++j) {
    JointMotion& m = scratch.motion[j];
    const JointDrive& d = model_.drives[j];
    if (d.kind == JointDrive::Kind::kept) continue;
    if (d.kind == JointDrive::Kind::value) m.value = out[d.output];
    if (d.kind == JointDrive::Kind::rotation) m.turn = euler_rotation(d.order, load3(&out[d.output], 0));
    if (d.kind == JointDrive::Kind::turn) m.turn = driver_.turn_at(d.output, t);
    apply_limits(model_.joints[j], m);
  }
  scratch.root = {load3(&out[model_.root_position], 0),
                  euler_rotation(model_.root_order, load3(&out[model_.root_rotation], 0))};
}

void Skeleton::hold_feet(State& s, double at, Scratch& scratch) const {
  const double t = own_time(s, at);
  IkWork& w = scratch.ik;
  w.poses.resize(model_.joints.size());
  forward_kinematics(model_.joints, scratch.motion, scratch.root, w.poses);
  double error = 0;
  for (size_t k = 0; k < clip_.feet(); ++k) {
    const Clip::Hold hold = clip_.hold(k, t);
    if (norm2(hold.move) == 0) continue;
    IkGoal g;
    g.joint = hold.foot, g.base = hold.base;
    g.target = w.poses[hold.foot].position + rotate(scratch.root.orientation, hold.move);
    const Quat sole = w.poses[hold.foot].orientation;
    const bool leg = model_.joints[hold.foot].parent != static_cast<int32_t>(hold.base);
    const IkOptions options{
        .method = leg ? IkMethod::two_link : IkMethod::ccd, .tolerance = 1e-6, .most = 10};
    solve_ik(model_.joints, scratch.root, std::span(&g, 1), options, scratch.motion, w);
    error = std::max(error, norm(g.target - w.poses[hold.foot].position));
    // The foot keeps its own orientation.
    JointMotion& foot = scratch.motion[hold.foot];
    if (model_.joints[hold.foot].kind == JointKind::ball) {
      foot.turn = normalized(foot.turn * conjugate(w.poses[hold.foot].orientation) * sole);
      forward_kinematics(model_.joints, scratch.motion, scratch.root, w.poses);
    }
  }
  s.f64(C::kSolved)[3] = error;
}

IkGoal Skeleton::goal(const GoalDrive& g, std::span<const double> out) const {
  IkGoal goal = g.goal;
  goal.target = load3(&out[g.target], 0);
  if (g.has_orientation) goal.orientation = euler_rotation(EulerOrder::xyz, load3(&out[g.orientation], 0));
  if (g.has_pole) goal.pole = load3(&out[g.pole], 0);
  return goal;
}

void Skeleton::reach(State& s, Scratch& scratch) const {
  IkWork& w = scratch.ik;
  scratch.goals.clear();
  for (const GoalDrive& g : model_.goals) scratch.goals.push_back(goal(g, scratch.driver.outputs));
  int natural = 0;
  if (!prior_.empty()) {
    natural = prior_
                  .solve(model_.joints, scratch.root, scratch.goals, prior_spread_, options_.most,
                         scratch.motion, w, scratch.prior)
                  .iterations;
  }
  const IkResult r = solve_ik(model_.joints, scratch.root, scratch.goals, options_, scratch.motion, w);
  s.f64(C::kSolved)[0] = r.error;
  s.f64(C::kSolved)[1] = r.iterations + natural;
  s.f64(C::kSolved)[2] = r.error <= options_.tolerance ? 1 : 0;
  const int32_t dragged = s.span<int32_t>(C::kDragJoint)[0];
  if (dragged < 0) return;
  // Drags come last; if a target is out of reach, least squares get as close as possible.
  IkGoal hand;
  hand.joint = static_cast<uint32_t>(dragged), hand.target = load3(s.f64(C::kDragTarget).data(), 0);
  hand.base = hand.joint;
  for (int32_t j = dragged; j >= 0; j = model_.joints[static_cast<size_t>(j)].parent) {
    hand.base = static_cast<uint32_t>(j);
  }
  solve_ik(model_.joints, scratch.root, std::span(&hand, 1), {.tolerance = options_.tolerance, .most = 30},
           scratch.motion, w);
}

void Skeleton::write(State& s, double h, Scratch& scratch) const {
  const std::vector<Pose>& poses = scratch.ik.poses;
  double *x = s.f64(C::kJointPosition).data(), *v = s.f64(C::kJointVelocity).data();
  for (size_t j = 0; j < poses.size(); ++j) {
    if (h > 0) store3(v, j, (poses[j].position - load3(x, j)) / h);
    store3(x, j, poses[j].position);
    const Quat q = normalized(poses[j].orientation);
    std::ranges::copy(std::array{q.w, q.x, q.y, q.z}, &s.f64(C::kJointOrientation)[4 * j]);
    write_motion(scratch.motion[j], &s.f64(C::kCoordinates)[8 * j]);
  }
  for (size_t b = 0; b < model_.bones.size(); ++b) {
    kMovedBones.place(s, b, poses[model_.bones[b].joint] * bone_poses_[b], h);
  }
}

void Skeleton::cover(State& s, double h, Scratch& scratch) const {
  const size_t n = model_.joints.size(), vertices = model_.skin.size();
  scratch.skin.resize(3 * vertices);
  const bool linear = skinning_ == SkinDef::Method::linear;
  scratch.matrices.resize(linear ? n : 0), scratch.duals.resize(linear ? 0 : n);
  for (size_t j = 0; j < n; ++j) {
    if (linear) {
      scratch.matrices[j] = bone_matrix(model_.rest[j], scratch.ik.poses[j]);
    } else {
      scratch.duals[j] = dual_quaternion(model_.rest[j], scratch.ik.poses[j]);
    }
  }
  const double* rest = &model_.skin[0].x;
  double* out = scratch.skin.data();
  const auto run = [&](size_t begin, size_t end) {
    if (linear) {
      skin_linear(scratch.matrices, model_.weights, rest, out, begin, end);
    } else {
      skin_dual_quaternion(scratch.duals, model_.weights, rest, out, begin, end);
    }
  };
  if (scratch.arena) {
    scratch.arena->for_blocks(vertices, kBlock, run);
  } else {
    run(0, vertices);
  }
  place_points(s.f64(C::kSkin), s.f64(C::kSkinVelocity), scratch.skin, h);
}

}  // namespace truestep::skeleton
