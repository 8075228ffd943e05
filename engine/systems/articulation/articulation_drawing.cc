// Drawing of an articulation: lines between joints and centres, shapes of the links, marks at joints.
#include "engine/collision/drawn_mesh.h"
#include "engine/systems/articulation/articulation.h"

namespace truestep::articulation {

void Articulation::draw(const State& s, double, Wish wishes, Drawing& out) const {
  if (wants(wishes, Wish::constant)) {
    out.parts.resize(2);
    draw_links(out.parts[0]);
    draw_lines(out.parts[1]);
  }
  if (wants(wishes, Wish::joints)) out.joints = joint_marks(s);
}

void Articulation::draw_lines(PartDrawing& t) const {
  const Model& m = tree_.model();
  const auto n = static_cast<uint32_t>(m.links.size());
  t.point_radius = point_radius_;
  for (uint32_t i = 0; i < n; ++i) {
    const Link& l = m.links[i];
    t.lines.push_back({n + i, i});
    const Vec3& center = l.parent == kGround ? Vec3{} : m.links[size_t(l.parent)].center;
    if (l.parent != kGround && norm(center) > 0) t.lines.push_back({static_cast<uint32_t>(l.parent), n + i});
    if (l.parent != kGround && norm(center) == 0)
      t.lines.push_back({n + static_cast<uint32_t>(l.parent), n + i});
  }
  t.line_kinds.assign(t.lines.size(), LineKind::structural);
  if (color_) t.color = std::array<double, 3>{color_->x, color_->y, color_->z};
}

void Articulation::draw_links(PartDrawing& out) const {
  const Model& m = tree_.model();
  for (uint32_t i = 0; i < m.links.size(); ++i) {
    const Link& l = m.links[i];
    for (const LinkShape& shape : m.shapes[l.def]) {
      Visual visual;
      // A link's row is its centre of mass with the orientation of its frame.
      visual.shape = drawn_shape(shape.solid, {shape.pose.position - l.center, shape.pose.orientation});
      visual.shape.id = l.id.empty() ? std::to_string(i) : l.id;
      visual.group = static_cast<uint32_t>(l.def);
      if (color_) visual.color = std::array<double, 3>{color_->x, color_->y, color_->z};
      out.instances.push_back({i, static_cast<uint32_t>(out.visuals.size())});
      out.visuals.push_back(std::move(visual));
    }
  }
}

std::vector<JointMark> Articulation::joint_marks(const State& s) const {
  using Kind = JointMark::Kind;
  const Tree& tree = tree_.model().tree;
  const Work work = tree_.placed(s);
  std::vector<spatial::Frame> frames(work.size());
  world_frames(tree, work, frames);
  std::vector<JointMark> out;
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    const Node& node = tree.nodes[i];
    const bool free = node.move == Move::translation ||
                      (node.parent != kGround && tree.nodes[size_t(node.parent)].move == Move::translation);
    if (free) continue;
    const bool along = node.move == Move::revolute || node.move == Move::prismatic;
    const Kind kind = node.move == Move::revolute    ? Kind::revolute
                      : node.move == Move::prismatic ? Kind::prismatic
                      : node.move == Move::spherical ? Kind::spherical
                                                     : Kind::fixed;
    out.push_back({kind, frames[i].p, frames[i].p, along ? frames[i].R.apply(node.axis) : Vec3{}});
  }
  const auto place = [&](int32_t node, const Vec3& at) {
    return node == kGround ? at : frames[size_t(node)].R.apply(at) + frames[size_t(node)].p;
  };
  for (const Closure& c : tree_.model().closures)
    out.push_back({Kind::spherical, place(c.a, c.at_a), place(c.b, c.at_b), {}});
  for (const LinkSpring& spring : tree_.model().springs)
    out.push_back({Kind::distance,
                   place(spring.between.a, spring.between.at_a),
                   place(spring.between.b, spring.between.at_b),
                   {}});
  return out;
}

}  // namespace truestep::articulation
