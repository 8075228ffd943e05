#include "engine/systems/articulation/link_bodies.h"

#include <algorithm>
#include <array>

#include "engine/systems/articulation/carried_links.h"
#include "engine/systems/articulation/frames.h"

namespace truestep::articulation {

/// Responses to unit impulses on a link, N s along and N m s about the three axes.
struct LinkResponse {
  uint64_t version = 0;         ///< of the positions it was computed at; 0: never
  std::vector<double> columns;  ///< 6 x velocities: changes of q'
  std::array<BodyTwist, 6> own{};

  static std::array<double, 6> numbers(const BodyImpulse& on) {
    return {on.impulse.x, on.impulse.y, on.impulse.z, on.twist.x, on.twist.y, on.twist.z};
  }
  void add(const BodyImpulse& on, std::span<double> change) const {
    const auto by = numbers(on);
    const size_t n = change.size();
    for (size_t k = 0; k < 6; ++k) {
      for (size_t i = 0; i < n; ++i) change[i] += by[k] * columns[k * n + i];
    }
  }
};

struct LinkBodies::Scratch {
  Work work;
  std::vector<spatial::Frame> frames;
  std::vector<Quat> turns;  ///< of the links
  std::vector<Push> pushes;
  std::vector<double> none, change, rate;
  ClosureWork closures;
  std::vector<LinkResponse> responses;
  uint64_t version = 1;  ///< of the positions
  bool posed = false;    ///< frames and turns are up to date with the state

  static Scratch& of(Workspace& memory) { return memory.object<Scratch>("articulation.bodies"); }
};

void LinkBodies::forget(Workspace& memory) const {
  Scratch& scratch = Scratch::of(memory);
  scratch.posed = false;
  for (LinkResponse& r : scratch.responses) r.version = 0;
}

LinkBodies::LinkBodies(const ArticulationField& field) : field_(field) {
  const Model& m = field.model();
  std::vector<bool> moves;
  for (const Node& n : m.tree.nodes) {
    const auto i = static_cast<int32_t>(root_of_.size());
    const bool root = n.parent == kGround;
    root_of_.push_back(root ? i : root_of_[size_t(n.parent)]);
    moves.push_back((!root && moves[size_t(n.parent)]) || velocities_of(n.move) > 0);
  }
  for (const Link& l : m.links) {
    const Node& node = m.tree.nodes[size_t(l.node)];
    BodyForm form;
    form.mass = moves[size_t(l.node)] ? std::max(node.inertia.m, 1e-300) : 0;
    std::vector<SolidPart> parts;
    for (const LinkShape& s : m.shapes[l.def]) {
      parts.push_back({s.solid, {s.pose.position - l.center, s.pose.orientation}});
    }
    if (!parts.empty()) form.solid = &solids_.emplace_back(compound_solid(std::move(parts)));
    forms_.push_back(form);
    // A free joint is a translation from the ground followed by a ball.
    const auto root = size_t(root_of_[size_t(l.node)]);
    const bool free = m.tree.nodes[root].move == Move::translation && root + 1 < m.tree.nodes.size() &&
                      m.tree.nodes[root + 1].move == Move::spherical &&
                      m.tree.nodes[root + 1].parent == static_cast<int32_t>(root);
    free_root_.push_back(free ? static_cast<int32_t>(root) + 1 : kGround);
  }
}

BodyMotion LinkBodies::motion(const State& s, size_t row) const {
  const Model& m = field_.model();
  return link_motion(m.tree, s.f64(Columns::kPosition), s.f64(Columns::kVelocity), m.links[row].node,
                     m.links[row].center);
}

void LinkBodies::pose(const State& s, Scratch& scratch) const {
  if (scratch.posed) return;
  const Model& m = field_.model();
  scratch.work.resize(m.tree.nodes.size()), scratch.frames.resize(m.tree.nodes.size());
  scratch.turns.resize(m.links.size());
  move(m.tree, s.f64(Columns::kPosition), {}, scratch.work);
  world_frames(m.tree, scratch.work, scratch.frames);
  for (size_t i = 0; i < m.links.size(); ++i) {
    scratch.turns[i] = quaternion(scratch.frames[size_t(m.links[i].node)].R);
  }
  scratch.posed = true;
}

void LinkBodies::motions(const State& s, std::span<BodyMotion> out, Workspace& memory) const {
  const Model& m = field_.model();
  Scratch& scratch = Scratch::of(memory);
  pose(s, scratch);
  velocities(m.tree, s.f64(Columns::kVelocity), scratch.work);
  for (size_t i = 0; i < out.size(); ++i) {
    const auto node = size_t(m.links[i].node);
    out[i] = motion_of(scratch.frames[node], scratch.turns[i], scratch.work[node].v, m.links[i].center);
  }
}

Push LinkBodies::push_of(size_t row, const BodyImpulse& on) const {
  const Link& l = field_.model().links[row];
  return {.node = l.node, .at = l.center, .force = on.impulse, .torque = on.twist};
}

// An impulse acts like a force for a short time: at rest, without gravity.
std::span<double> LinkBodies::respond(const State& s, Scratch& scratch) const {
  const Model& m = field_.model();
  const auto q = s.f64(Columns::kPosition);
  scratch.work.resize(m.tree.nodes.size());
  scratch.none.assign(m.tree.velocities, 0.0), scratch.change.resize(m.tree.velocities);
  if (m.closures.empty()) {
    accelerations(m.tree, q, {}, scratch.none, {}, scratch.pushes, scratch.work, scratch.change);
  } else {
    closed_accelerations(m.tree, m.closures, q, {}, scratch.none, {}, scratch.pushes, scratch.work,
                         scratch.closures, scratch.change);
  }
  return scratch.change;
}

BodyTwist LinkBodies::twist_of(size_t row, Scratch& scratch) const {
  const Model& m = field_.model();
  const Link& l = m.links[row];
  const spatial::Motion& a = scratch.work[size_t(l.node)].a;
  const Rotation R = world_frame(m.tree, scratch.work, l.node).R;
  return {R.apply(a.v + cross(a.w, l.center)), R.apply(a.w)};
}

const LinkResponse& LinkBodies::response(const State& s, size_t row, Scratch& scratch) const {
  const size_t n = field_.model().tree.velocities;
  if (scratch.responses.empty()) {
    scratch.responses.resize(forms_.size());
    for (LinkResponse& each : scratch.responses) each.columns.resize(6 * n);
  }
  LinkResponse& r = scratch.responses[row];
  for (size_t k = 0; k < 6; ++k) {
    const Vec3 unit{double(k % 3 == 0), double(k % 3 == 1), double(k % 3 == 2)};
    scratch.pushes.assign(1, push_of(row, k < 3 ? BodyImpulse{unit, {}} : BodyImpulse{{}, unit}));
    std::ranges::copy(respond(s, scratch), r.columns.begin() + static_cast<ptrdiff_t>(k * n));
    r.own[k] = twist_of(row, scratch);
  }
  r.version = scratch.version;
  return r;
}

const LinkResponse& LinkBodies::response_now(const State& s, size_t row, Scratch& scratch) const {
  const bool known = row < scratch.responses.size() && scratch.responses[row].version == scratch.version;
  return known ? scratch.responses[row] : response(s, row, scratch);
}

BodyTwist LinkBodies::answer(const State& s, size_t row, const BodyImpulse& on, Workspace& memory) const {
  const LinkResponse& r = response_now(s, row, Scratch::of(memory));
  const auto by = LinkResponse::numbers(on);
  BodyTwist out;
  for (size_t k = 0; k < 6; ++k) out.velocity += r.own[k].velocity * by[k], out.spin += r.own[k].spin * by[k];
  return out;
}

void LinkBodies::answers(const State& s, std::span<const BodyImpulse> on, std::span<BodyTwist> out,
                         Workspace& memory) const {
  Scratch& scratch = Scratch::of(memory);
  scratch.pushes.clear();
  for (size_t i = 0; i < on.size(); ++i) {
    if (!on[i].none()) scratch.pushes.push_back(push_of(i, on[i]));
  }
  respond(s, scratch);
  for (size_t i = 0; i < out.size(); ++i) out[i] = twist_of(i, scratch);
}

void LinkBodies::push(State& s, size_t row, const BodyImpulse& on, Workspace& memory) const {
  response_now(s, row, Scratch::of(memory)).add(on, s.f64(Columns::kVelocity));
}

// For a root's tree: kg m/s, and kg m^2/s about the origin.
spatial::Force LinkBodies::momentum(const State& s, int32_t root, Scratch& scratch) const {
  const Tree& tree = field_.model().tree;
  pose(s, scratch);
  velocities(tree, s.f64(Columns::kVelocity), scratch.work);
  spatial::Force sum;
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    if (root_of_[i] == root) sum += scratch.frames[i].out(tree.nodes[i].inertia * scratch.work[i].v);
  }
  return sum;
}

void LinkBodies::shift(State& s, size_t row, const BodyImpulse& by, const Vec3& gained,
                       Workspace& memory) const {
  const Model& m = field_.model();
  Scratch& scratch = Scratch::of(memory);
  const int32_t carrier = free_root_[row];
  const int32_t root = root_of_[size_t(m.links[row].node)];
  spatial::Force wanted;
  if (carrier != kGround) {
    wanted = momentum(s, root, scratch);
    wanted.n += cross(by.impulse, motion(s, row).velocity) - gained;
  }
  // The response at the positions where the search began is used: corrections are short, and gaps are
  // measured again.
  const bool known = row < scratch.responses.size() && scratch.responses[row].version > 0;
  const LinkResponse& r = known ? scratch.responses[row] : response(s, row, scratch);
  scratch.change.assign(m.tree.velocities, 0.0);
  r.add(by, scratch.change);
  const auto q = s.f64(Columns::kPosition);
  scratch.rate.resize(q.size());
  position_rate(m.tree, q, scratch.change, scratch.rate);
  for (size_t i = 0; i < q.size(); ++i) q[i] += scratch.rate[i];
  normalise(m.tree, q);
  scratch.posed = false, ++scratch.version;
  if (carrier == kGround) return;
  const spatial::Force missing = wanted - momentum(s, root, scratch);
  const Vec3 origin = scratch.frames[size_t(carrier)].p;
  scratch.pushes.assign(
      1, Push{.node = carrier, .force = missing.f, .torque = missing.n - cross(origin, missing.f)});
  const auto change = respond(s, scratch);
  const auto v = s.f64(Columns::kVelocity);
  for (size_t i = 0; i < v.size(); ++i) v[i] += change[i];
}

void LinkBodies::carry(State& s, std::span<const BodyMotion> to, std::span<const uint8_t> given,
                       Workspace& memory) const {
  Scratch& scratch = Scratch::of(memory);
  carry_links(field_.model(), to, given, s.f64(Columns::kPosition), s.f64(Columns::kVelocity),
              memory.object<CarryWork>("articulation.carry"));
  scratch.posed = false, ++scratch.version;
}

}  // namespace truestep::articulation
