#include "engine/systems/articulation/articulation_field.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/integrators/control/spectrum.h"
#include "engine/systems/articulation/ball_limits.h"

namespace truestep::articulation {

namespace {

struct LimitPush {
  double effort = 0, energy = 0;
};
LimitPush limit_push(const Drive& d, double q, double v) {
  const bool low = d.limits == Drive::Limits::lower || d.limits == Drive::Limits::both;
  const bool high = d.limits == Drive::Limits::upper || d.limits == Drive::Limits::both;
  if (low && q < d.lowest) {
    const double s = d.lowest - q;
    return {std::max(0.0, d.limit_stiffness * s - d.limit_damping * v), 0.5 * d.limit_stiffness * s * s};
  }
  if (high && q > d.highest) {
    const double s = q - d.highest;
    return {std::min(0.0, -d.limit_stiffness * s - d.limit_damping * v), 0.5 * d.limit_stiffness * s * s};
  }
  return {};
}

bool one_axis(Move m) {
  return m == Move::revolute || m == Move::prismatic;
}

double length2(const double* q) {
  return q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
}

}  // namespace

ArticulationField::ArticulationField(Model model, const Vec3& gravity)
    : model_(std::move(model)), gravity_(gravity) {
  refuse_empty_joints();
  close_start();
  // Coupled joints are faster than each on its own.
  const Spectrum whole = estimate_spectrum(*this, initial_state(), 0, kRoughSpectrum);
  stiffness_.omega = std::max(stiffness_.omega, whole.omega);
  stiffness_.damping = std::max(stiffness_.damping, whole.damping);
}

void ArticulationField::close_start() {
  if (model_.closures.empty()) return;
  ClosureWork scratch;
  close(model_.tree, model_.closures, model_.q, model_.v, scratch);
  if (!(gap(model_.tree, model_.closures, model_.q, scratch.work) < 1e-10)) {
    const std::string why = "the loops cannot be closed from where the links start";
    throw Error("scene_invalid", why,
                {"/closures", "not_closed", why, "", "a start close to one with closed loops", "", ""});
  }
}

void ArticulationField::refuse_empty_joints() {
  // Without closures: the pivots of the tree itself.
  Work work(model_.tree.nodes.size());
  const std::vector<double> rest(model_.v.size(), 0.0);
  std::vector<double> a(model_.v.size());
  accelerations(model_.tree, model_.q, rest, rest, {}, {}, work, a);
  const auto weight = [&](int32_t node) {
    return node == kGround || model_.tree.nodes[size_t(node)].inertia.m == 0
               ? 0
               : 1 / model_.tree.nodes[size_t(node)].inertia.m;
  };
  for (const LinkSpring& s : model_.springs) {
    const double w = weight(s.between.a) + weight(s.between.b);
    stiffness_.omega = std::max(stiffness_.omega, std::sqrt(s.stiffness * w));
    stiffness_.damping = std::max(stiffness_.damping, s.damping * w);
  }
  // Leaves first: infinities travel towards the ground.
  for (size_t k = model_.links.size(); k-- > 0;) {
    const Link& link = model_.links[k];
    for (int32_t i = link.node;
         i != (link.parent == kGround ? kGround : model_.links[size_t(link.parent)].node);
         i = model_.tree.nodes[size_t(i)].parent) {
      const Node& n = model_.tree.nodes[size_t(i)];
      if (n.move == Move::fixed) continue;
      const NodeWork& w = work[size_t(i)];
      // Inertia that the joint moves, kg or kg m^2 (for three directions, a lower bound of the least),
      // against rounding of all that it carries.
      const spatial::Symmetric& block =
          n.move == Move::revolute || n.move == Move::spherical ? w.inertia.A : w.inertia.C;
      const double trace = block.xx + block.yy + block.zz;
      const double moved = one_axis(n.move) ? 1 / w.Dinv.xx : spatial::determinant(block) / (trace * trace);
      if (!(trace > 0) || !(moved > 1e-12 * trace) || !std::isfinite(moved)) {
        const std::string why = "the joint has no inertia to move in its direction";
        throw Error("scene_invalid", why,
                    {"/links/" + std::to_string(link.def), "no_inertia", why, "",
                     "mass away from the axis, or an inertia", "", ""});
      }
      const Drive& d = model_.drives[size_t(i)];
      const double k = d.stiffness + (d.limited() ? d.limit_stiffness : 0);
      const double c = d.damping + (d.limited() ? d.limit_damping : 0);
      stiffness_.omega = std::max(stiffness_.omega, std::sqrt(k / moved));
      stiffness_.damping = std::max(stiffness_.damping, c / moved);
    }
  }
}

State ArticulationField::initial_state() const {
  State s;
  s.add({"position", "1", Scalar::f64, 1, Role::position}, model_.q.size());
  s.add({"velocity", "1/s", Scalar::f64, 1, Role::velocity}, model_.v.size());
  s.add({"torque", "N m"}, model_.torque.size());
  s.add({"gravity", "m/s^2", Scalar::f64, 3}, 1);
  s.add({"push.link", "1", Scalar::u32}, 0);
  s.add({"push.force", "N", Scalar::f64, 3}, 0);
  s.add({"push.at", "m", Scalar::f64, 3}, 0);
  s.add({"push.remaining", "s"}, 0);
  std::ranges::copy(model_.q, s.f64(Columns::kPosition).begin());
  std::ranges::copy(model_.v, s.f64(Columns::kVelocity).begin());
  std::ranges::copy(model_.torque, s.f64(Columns::kTorque).begin());
  store3(s.f64(Columns::kGravity).data(), 0, gravity_);
  return s;
}

void ArticulationField::efforts(const Phase& at, std::span<double> tau) const {
  std::ranges::copy(at.state.f64(Columns::kTorque), tau.begin());
  for (size_t i = 0; i < model_.drives.size(); ++i) {
    const Drive& d = model_.drives[i];
    if (!d.anything()) continue;
    const Node& n = model_.tree.nodes[i];
    const double* q = at.x.data() + n.q;
    for (uint32_t k = 0; k < velocities_of(n.move); ++k) tau[n.v + k] -= d.damping * at.v[n.v + k];
    if (one_axis(n.move)) {
      tau[n.v] += limit_push(d, q[0], at.v[n.v]).effort - d.stiffness * (q[0] - d.rest);
    } else if (n.move == Move::spherical) {
      const double k = 2 * d.stiffness * q[0] / length2(q);
      for (uint32_t j = 0; j < 3; ++j) tau[n.v + j] -= k * q[j + 1];
      if (!d.limited()) continue;
      const Vec3 push = ball_limit(d, n.axis, q, load3(at.v.data() + n.v, 0)).torque;
      tau[n.v] += push.x, tau[n.v + 1] += push.y, tau[n.v + 2] += push.z;
    } else if (n.move == Move::translation) {
      for (uint32_t j = 0; j < 3; ++j) tau[n.v + j] -= d.stiffness * q[j];
    }
  }
}

void ArticulationField::add_pushes(const State& state, std::vector<Push>& out) const {
  for (size_t k = 0; k < Columns::kHands.pushes(state); ++k) {
    const UserForces::Push p = Columns::kHands.push(state, k);
    out.push_back({.node = model_.links[p.who].node, .at = p.at, .force = p.force});
  }
}

Vec3 ArticulationField::reach(const LinkSpring& s, std::span<const NodeWork> work, Of what) const {
  return point(model_.tree, work, s.between.a, s.between.at_a, what, {}) -
         point(model_.tree, work, s.between.b, s.between.at_b, what, {});
}

void ArticulationField::pull_spring(const LinkSpring& s, std::span<const NodeWork> work,
                                    std::vector<Push>& pushes) const {
  const Vec3 d = reach(s, work, Of::place);
  const double length = norm(d);
  if (!(length > 0)) return;
  const Vec3 along = d / length;
  const double tension =
      s.stiffness * (length - s.rest_length) + s.damping * dot(along, reach(s, work, Of::velocity));
  pushes.push_back({.node = s.between.a, .at = s.between.at_a, .force = along * -tension});
  pushes.push_back({.node = s.between.b, .at = s.between.at_b, .force = along * tension});
}

void ArticulationField::solve(const Phase& at, std::span<NodeWork> work, std::span<double> tau,
                              ClosureWork& scratch, std::span<double> a) const {
  efforts(at, tau);
  const Vec3 gravity = load3(at.state.f64(Columns::kGravity).data(), 0);
  scratch.outside.clear();
  add_pushes(at.state, scratch.outside);
  scratch.outside.insert(scratch.outside.end(), model_.loads.begin(), model_.loads.end());
  if (!model_.springs.empty()) {
    move(model_.tree, at.x, at.v, work);
    for (const LinkSpring& s : model_.springs) pull_spring(s, work, scratch.outside);
  }
  if (model_.closures.empty()) {
    accelerations(model_.tree, at.x, at.v, tau, gravity, scratch.outside, work, a);
  } else {
    closed_accelerations(model_.tree, model_.closures, at.x, at.v, tau, gravity, scratch.outside, work,
                         scratch, a);
  }
}

void ArticulationField::acceleration(const Phase& at, std::span<double> a, Evaluation& e) const {
  auto& work = e.workspace.object<Work>("articulation.nodes");
  work.resize(model_.tree.nodes.size());
  solve(at, work, e.workspace.doubles("articulation.efforts", at.v.size()),
        e.workspace.object<ClosureWork>("articulation.closures"), a);
}

std::span<const double> ArticulationField::position_rate(const Phase& at, std::span<double> rate,
                                                         Evaluation&) const {
  if (at.x.size() == at.v.size()) return at.v;
  articulation::position_rate(model_.tree, at.x, at.v, rate);
  return rate;
}

void ArticulationField::project(std::span<double> x, std::span<double>, const State&) const {
  if (model_.tree.positions != model_.tree.velocities) normalise(model_.tree, x);
}

double ArticulationField::kinetic(const Phase& at, Evaluation& e) const {
  auto& work = e.workspace.object<Work>("articulation.nodes");
  work.resize(model_.tree.nodes.size());
  move(model_.tree, at.x, at.v, work);
  double sum = 0;
  for (size_t i = 0; i < work.size(); ++i) {
    sum += 0.5 * spatial::dot(work[i].v, model_.tree.nodes[i].inertia * work[i].v);
  }
  return sum;
}

std::optional<double> ArticulationField::potential(const Phase& at, Evaluation& e) const {
  auto& work = e.workspace.object<Work>("articulation.nodes");
  auto& frames = e.workspace.object<std::vector<spatial::Frame>>("articulation.frames");
  work.resize(model_.tree.nodes.size()), frames.resize(work.size());
  move(model_.tree, at.x, at.v, work);
  world_frames(model_.tree, work, frames);
  const Vec3 g = load3(at.state.f64(Columns::kGravity).data(), 0);
  double sum = 0;
  for (size_t i = 0; i < work.size(); ++i) {
    const Node& n = model_.tree.nodes[i];
    sum -= dot(g, frames[i].p * n.inertia.m + frames[i].R.apply(n.inertia.h));
    const Drive& d = model_.drives[i];
    if (!d.anything()) continue;
    const double* q = at.x.data() + n.q;
    if (one_axis(n.move)) {
      sum += limit_push(d, q[0], 0).energy + 0.5 * d.stiffness * (q[0] - d.rest) * (q[0] - d.rest);
    } else if (n.move == Move::spherical) {
      sum += 2 * d.stiffness * (1 - q[0] * q[0] / length2(q));
      if (d.limited()) sum += ball_limit(d, n.axis, q, {}).energy;
    } else if (n.move == Move::translation) {
      sum += 0.5 * d.stiffness * norm2(load3(q, 0));
    }
  }
  for (const Push& p : model_.loads) {
    const spatial::Frame& f = frames[size_t(p.node)];
    if (p.axes == Push::Axes::world) sum -= dot(p.force, f.p + f.R.apply(p.at));
  }
  for (const LinkSpring& s : model_.springs) {
    const double stretch = norm(reach(s, work, Of::place)) - s.rest_length;
    sum += 0.5 * s.stiffness * stretch * stretch;
  }
  return sum;
}

std::optional<ForceField::Stiffness> ArticulationField::stiffness(const State&) const {
  if (stiffness_.omega == 0 && stiffness_.damping == 0) return std::nullopt;
  return stiffness_;
}

Work ArticulationField::placed(const State& s) const {
  Work work(model_.tree.nodes.size());
  move(model_.tree, s.f64(Columns::kPosition), s.f64(Columns::kVelocity), work);
  return work;
}

Work ArticulationField::accelerated(const State& s) const {
  Work work(model_.tree.nodes.size());
  std::vector<double> tau(model_.v.size()), a(model_.v.size());
  ClosureWork scratch;
  solve({0, s.f64(Columns::kPosition), s.f64(Columns::kVelocity), s}, work, tau, scratch, a);
  return work;
}

std::vector<double> ArticulationField::response(const State& s, size_t link, const Vec3& impulse,
                                                const Vec3& at) const {
  // An impulse acts like a force for a short time: at rest, without gravity.
  const std::vector<double> rest(model_.v.size(), 0.0);
  std::vector<double> change(model_.v.size());
  Work work(model_.tree.nodes.size());
  const Link& l = model_.links[link];
  const Push push{.node = l.node, .at = at, .force = impulse};
  accelerations(model_.tree, s.f64(Columns::kPosition), rest, rest, {}, {&push, 1}, work, change);
  return change;
}

Vec3 ArticulationField::hold(const State& s, size_t link, const std::optional<Vec3>& place) const {
  const Link& l = model_.links[link];
  if (!place) return l.center;
  const Work work = placed(s);
  const spatial::Frame f = world_frame(model_.tree, work, l.node);
  return f.R.apply_inverse(*place - f.p);
}

}  // namespace truestep::articulation
