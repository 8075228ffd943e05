// A skeleton that bodies lead, and its return to its own motion: it resumes at the time t' of its motion
// whose joints y_j, turned about the vertical by a and shifted on the ground, best match where the bodies
// left them, x_j,
//   min over t', a, s of  sum |R(a) y_j(t') + s - x_j|^2,
// with a and s in closed form (Kovar, Gleicher, Pighin 2002, "Motion graphs", eqs. 2 to 4).
#include <cmath>

#include "engine/systems/skeleton/scratch.h"

namespace truestep::skeleton {

using namespace animation;
using C = SkeletonColumns;

namespace {

constexpr double kItself = 0, kBodies = 1, kItselfAgain = 2;  // who leads
constexpr int kTimesTried = 64;

double smooth_lead(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}
Pose between(const Pose& a, const Pose& b, double s) {
  return {a.position + (b.position - a.position) * s, slerp(a.orientation, b.orientation, s)};
}

/// The turn about y and the shift on the ground that best align joints at `poses` with x; and the residual.
struct Fit {
  Pose placement;
  double cost = 0;
};
Fit fit_on_ground(std::span<const Pose> poses, const double* x) {
  const auto n = static_cast<double>(poses.size());
  Vec3 from, to;
  for (size_t j = 0; j < poses.size(); ++j) from += poses[j].position / n, to += load3(x, j) / n;
  double cosine = 0, sine = 0;
  for (size_t j = 0; j < poses.size(); ++j) {
    const Vec3 a = poses[j].position - from, b = load3(x, j) - to;
    cosine += a.x * b.x + a.z * b.z, sine += a.z * b.x - a.x * b.z;
  }
  Fit fit;
  fit.placement.orientation = turn_about({0, 1, 0}, trig::atan2(sine, cosine));
  fit.placement.position = to - rotate(fit.placement.orientation, from);
  fit.placement.position.y = 0;
  for (size_t j = 0; j < poses.size(); ++j) {
    fit.cost += norm2((fit.placement * poses[j]).position - load3(x, j));
  }
  return fit;
}

}  // namespace

void Skeleton::prepare(State& s) const {
  if (lead_rows(s)) return;
  const size_t n = model_.joints.size();
  s.resize(C::kCoordinates, 2 * n + LeadRows::rows);
  double* lead = lead_rows(s);
  Scratch scratch;
  drive_at(s, 0, scratch);
  for (const size_t pose : {LeadRows::placement, LeadRows::left_root}) write_pose({}, lead + pose);
  write_pose(scratch.root, lead + LeadRows::root);
}

bool Skeleton::is_led(const State& s) const {
  const double* lead = lead_rows(s);
  return lead && lead[LeadRows::by] == kBodies;
}

double Skeleton::own_time(const State& s, double t) const {
  const double* lead = lead_rows(s);
  return lead ? t + lead[LeadRows::shift] : t;
}

void Skeleton::follow(State& s, std::span<const Pose> bones, std::span<const uint8_t> given, double h,
                      Workspace& workspace) const {
  auto& scratch = workspace.object<Scratch>("skeleton");
  double* lead = lead_rows(s);
  lead[LeadRows::by] = kBodies;
  const size_t n = model_.joints.size();
  scratch.motion.resize(n), scratch.ik.poses.resize(n);
  scratch.root = read_pose(lead + LeadRows::root);
  std::vector<Pose>& poses = scratch.ik.poses;
  // Bones are in the order of their joints.
  size_t b = 0;
  for (size_t j = 0; j < n; ++j) {
    const Joint& joint = model_.joints[j];
    JointMotion& m = scratch.motion[j];
    m = read_motion(&s.f64(C::kCoordinates)[8 * j]);
    const Pose before =
        (joint.parent < 0 ? scratch.root : poses[static_cast<size_t>(joint.parent)]) * joint.rest;
    bool found = false;
    for (; b < model_.bones.size() && model_.bones[b].joint == j; ++b) {
      if (found || !given[b]) continue;
      found = true;
      const Quat turn = normalized(bones[b].orientation * conjugate(bone_poses_[b].orientation));
      const Quat local = normalized(conjugate(before.orientation) * turn);
      if (joint.kind == JointKind::ball) m.turn = nearer(m.turn, local);
      if (joint.kind == JointKind::revolute) m.value = swing_twist(local, joint.axis).twist;
      const Vec3 place = bones[b].position - rotate(turn, bone_poses_[b].position);
      const Vec3 way = rotate(conjugate(before.orientation), place - before.position);
      Vec3 along;
      if (joint.kind == JointKind::prismatic) m.value = dot(way, joint.axis), along = joint.axis * m.value;
      // Connected bodies determine the root's position; the rest follows from their rotations.
      if (joint.parent < 0) m.shift = way - along;
    }
    poses[j] =
        (joint.parent < 0 ? scratch.root : poses[static_cast<size_t>(joint.parent)]) * local_pose(joint, m);
  }
  write(s, h, scratch);
  if (!model_.skin.empty()) cover(s, h, scratch);
}

void Skeleton::resume(State& s, double t, const PoseMatch& match, Workspace& workspace) const {
  auto& scratch = workspace.object<Scratch>("skeleton");
  double* lead = lead_rows(s);
  lead[LeadRows::by] = kItselfAgain, lead[LeadRows::start] = t, lead[LeadRows::blend] = match.blend;
  const double* c = s.f64(C::kCoordinates).data();
  std::copy_n(c, 8 * model_.joints.size(), lead - 8 * model_.joints.size());
  std::copy_n(lead + LeadRows::root, 7, lead + LeadRows::left_root);
  const int tried = match.to > match.from ? kTimesTried : 1;
  double best = HUGE_VAL;
  for (int k = 0; k < tried; ++k) {
    const double at = tried > 1 ? match.from + (match.to - match.from) * k / (tried - 1) : own_time(s, t);
    drive_at(s, at, scratch);
    scratch.ik.poses.resize(model_.joints.size());
    forward_kinematics(model_.joints, scratch.motion, scratch.root, scratch.ik.poses);
    const Fit fit = fit_on_ground(scratch.ik.poses, s.f64(C::kJointPosition).data());
    if (fit.cost >= best) continue;
    best = fit.cost;
    lead[LeadRows::shift] = at - t;
    write_pose(fit.placement, lead + LeadRows::placement);
  }
}

void Skeleton::blend_back(State& s, double t, Scratch& scratch) const {
  double* lead = lead_rows(s);
  if (!lead) return;
  if (lead[LeadRows::by] == kItselfAgain) {
    const double length = lead[LeadRows::blend];
    const double share = length > 0 ? smooth_lead((t - lead[LeadRows::start]) / length) : 1;
    if (share >= 1) lead[LeadRows::by] = kItself;
    const double* left = lead - 8 * model_.joints.size();
    for (size_t j = 0; j < model_.joints.size(); ++j) {
      const JointMotion from = read_motion(left + 8 * j);
      JointMotion& m = scratch.motion[j];
      m.value = from.value + (m.value - from.value) * share;
      m.turn = slerp(from.turn, m.turn, share);
      m.shift = from.shift + (m.shift - from.shift) * share;
    }
    scratch.root = between(read_pose(lead + LeadRows::left_root), scratch.root, share);
    forward_kinematics(model_.joints, scratch.motion, scratch.root, scratch.ik.poses);
  }
  write_pose(scratch.root, lead + LeadRows::root);
}

}  // namespace truestep::skeleton
