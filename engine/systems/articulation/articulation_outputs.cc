// What an articulation gives out: the motion of its links, and the forces of the joints that hold them.
#include "engine/core/equations/force_outputs.h"
#include "engine/core/outputs/outputs_of.h"
#include "engine/systems/articulation/articulation.h"
#include "engine/systems/articulation/frames.h"

namespace truestep::articulation {
namespace {

std::vector<spatial::Frame> frames_of(const Tree& tree, const Work& work) {
  std::vector<spatial::Frame> out(work.size());
  world_frames(tree, work, out);
  return out;
}

void put(double* out, size_t row, const Vec3& v) {
  store3(out, row, v);
}
void put(double* out, size_t row, const Quat& q) {
  out[4 * row] = q.w, store3(out + 4 * row + 1, 0, Vec3{q.x, q.y, q.z});
}

enum class Rows : uint8_t { links, skeleton };

/// A part of the motion of every link's centre; of a skeleton then of every joint's origin.
template <class Value>
auto motions(Value BodyMotion::*part, Rows rows = Rows::links) {
  return computed_by<Articulation>([=](const Articulation& a, const State& s, ShownRows, double* out) {
    const auto& tree = static_cast<const ArticulationField&>(a.force_field());
    const Work work = tree.placed(s);
    const auto frames = frames_of(tree.model().tree, work);
    const auto& links = tree.model().links;
    const auto put_motion = [&](size_t row, const Link& l, const Vec3& at) {
      const auto& f = frames[static_cast<size_t>(l.node)];
      put(out, row, motion_of(f, quaternion(f.R), work[static_cast<size_t>(l.node)].v, at).*part);
    };
    for (size_t i = 0; i < links.size(); ++i) {
      put_motion(i, links[i], links[i].center);
      if (rows == Rows::skeleton) put_motion(links.size() + i, links[i], {});
    }
  });
}
/// What the joint of every link exerts on it.
auto joint_loads(Vec3 spatial::Force::*part) {
  return computed_by<Articulation>([=](const Articulation& a, const State& s, ShownRows, double* out) {
    const auto& tree = static_cast<const ArticulationField&>(a.force_field());
    const Work work = tree.accelerated(s);
    const auto frames = frames_of(tree.model().tree, work);
    for (const Link& l : tree.model().links) {
      const auto node = static_cast<size_t>(l.node);
      store3(out, 0, frames[node].R.apply(joint_force(work[node]).*part)), out += 3;
    }
  });
}

/// W, of the constant forces and torques that have no potential.
double applied_power(const Model& m, const Work& work, const std::vector<spatial::Frame>& frames) {
  double power = 0;
  for (const Push& p : m.loads) {
    const NodeWork& w = work[static_cast<size_t>(p.node)];
    const Rotation& R = frames[static_cast<size_t>(p.node)].R;
    const bool turning = p.axes == Push::Axes::node;
    if (turning) power += dot(p.force, w.v.v + cross(w.v.w, p.at));
    power += dot(turning ? p.torque : R.apply_inverse(p.torque), w.v.w);
  }
  return power;
}

}  // namespace

struct Articulation::Whole {
  Vec3 momentum{}, angular_momentum{};
  std::optional<double> gap = {}, power = {};
};

const OutputTable& Articulation::outputs() {
  using A = Articulation;
  static const OutputTable kTable =
      OutputsOf<A>(
          "a link in the order of links; of part skeleton the links, then the origins of their joints, which "
          "lines connect")
          .part("", [](const A& a) { return points_part(a.tree_.model().links.size()); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, motions(&BodyMotion::place),
                 "centres of mass; in part skeleton also origins of joints")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, motions(&BodyMotion::velocity),
                 "of the same")
          .field({"orientation", "1", Scalar::f64, 4, Meaning::orientation},
                 motions(&BodyMotion::orientation), "unit quaternion w x y z")
          .field({"angular_velocity", "rad/s", Scalar::f64, 3}, motions(&BodyMotion::spin), "in the world")
          .field({"joint_force", "N", Scalar::f64, 3}, joint_loads(&spatial::Force::f),
                 "exerted by the joint on its link, in the world")
          .field({"joint_moment", "N m", Scalar::f64, 3}, joint_loads(&spatial::Force::n),
                 "about the joint's origin")
          .part("skeleton", [](const A& a) { return points_part(2 * a.tree_.model().links.size()); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position},
                 motions(&BodyMotion::place, Rows::skeleton), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity},
                 motions(&BodyMotion::velocity, Rows::skeleton), "")
          .measured(force_energies, kForceEnergyRows)
          .measured(held_steps, kHeldStepsRows)
          .measured(&A::whole,
                    {{"momentum", "kg m/s", &Whole::momentum, "of everything that moves freely"},
                     {"angular_momentum", "kg m^2/s", &Whole::angular_momentum, "about the origin"},
                     {"loops.gap", "m", &Whole::gap, "largest distance between points that a loop joins"},
                     {"power.applied", "W", &Whole::power,
                      "if links have a constant force or torque: of those without a potential"}})
          .build();
  return kTable;
}

const Outputs& articulation_outputs() {
  static const Outputs kDescribed = Articulation::outputs().described();
  return kDescribed;
}

Articulation::Whole Articulation::whole(const State& s, double) const {
  const Model& m = tree_.model();
  const Work work = tree_.placed(s);
  const auto frames = frames_of(m.tree, work);
  Whole out;
  for (size_t i = 0; i < work.size(); ++i) {
    const spatial::Force h = frames[i].out(m.tree.nodes[i].inertia * work[i].v);
    out.momentum += h.f, out.angular_momentum += h.n;
  }
  if (!m.loads.empty()) out.power = applied_power(m, work, frames);
  if (!m.closures.empty()) {
    Work at_rest(m.tree.nodes.size());
    out.gap = gap(m.tree, m.closures, s.f64(Columns::kPosition), at_rest);
  }
  return out;
}

}  // namespace truestep::articulation
