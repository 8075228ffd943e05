#include "engine/systems/articulation/model.h"

#include <algorithm>
#include <map>

#include "engine/geometry/mass_properties.h"
#include "engine/kernels/rigid/free_rotation.h"

namespace truestep::articulation {
namespace {

Solid solid_of(const AnyLinkShapeDef& d) {
  struct Make {
    Solid operator()(const SphereLinkDef& s) { return sphere_solid(s.radius); }
    Solid operator()(const BoxLinkDef& s) { return box_solid(s.half_extents); }
    Solid operator()(const CapsuleLinkDef& s) { return capsule_solid(s.radius, s.half_length); }
    Solid operator()(const CylinderLinkDef& s) { return cylinder_solid(s.radius, s.half_length); }
  };
  return std::visit(Make{}, d);
}

std::vector<LinkShape> shapes_of(const LinkDef& d) {
  std::vector<LinkShape> out;
  for (const AnyLinkShapeDef& s : d.shapes) {
    const LinkShapeDef& at = std::visit([](const auto& x) -> const LinkShapeDef& { return x; }, s);
    out.push_back({solid_of(s), {at.position, free_rotation::turn(at.rotation)}});
  }
  return out;
}

MassProperties mass_of(const LinkDef& d, const std::vector<LinkShape>& shapes) {
  MassProperties all;
  if (shapes.empty() || !d.inertia.empty()) {
    all.mass = d.mass.value_or(0), all.center = d.center;
    const auto& I = d.inertia;
    if (I.size() >= 3) all.inertia = {I[0], I[1], I[2], 0, 0, 0};
    if (I.size() == 6) all.inertia.xy = I[3], all.inertia.xz = I[4], all.inertia.yz = I[5];
    return all;
  }
  for (size_t i = 0; i < shapes.size(); ++i) {
    const MassProperties one =
        placed(mass_properties(shapes[i].solid, d.density), transform_of(shapes[i].pose));
    all = i == 0 ? one : all + one;
  }
  if (d.mass) all.inertia = all.inertia * (*d.mass / all.mass), all.mass = *d.mass;
  return all;
}

spatial::Inertia inertia_of(const MassProperties& m) {
  const Symmetric3 I = inertia_about(m, {});
  return {m.mass, m.center * m.mass, {I.xx, I.yy, I.zz, I.xy, I.xz, I.yz}};
}

struct Part {
  Move move;
  Vec3 axis;
};
std::vector<Part> parts_of(const LinkDef& d) {
  const Vec3 a = normalized(d.axis), b = normalized(d.second_axis);
  switch (d.joint) {
    case JointType::revolute:
      return {{Move::revolute, a}};
    case JointType::prismatic:
      return {{Move::prismatic, a}};
    case JointType::spherical:
      return {{Move::spherical, a}};
    case JointType::universal:
      return {{Move::revolute, a}, {Move::revolute, b}};
    case JointType::cylindrical:
      return {{Move::prismatic, a}, {Move::revolute, a}};
    case JointType::free:
      return {{Move::translation, a}, {Move::spherical, a}};
    case JointType::fixed:
      break;
  }
  return {{Move::fixed, a}};
}

Drive drive_of(const LinkDef& d, size_t part) {
  Drive r{d.damping,         d.stiffness,    d.rest, d.lowest.value_or(0), d.highest.value_or(0),
          d.limit_stiffness, d.limit_damping};
  if (part == 0 && d.joint != JointType::fixed) {
    r.limits = d.lowest && d.highest ? Drive::Limits::both
               : d.lowest            ? Drive::Limits::lower
               : d.highest           ? Drive::Limits::upper
                                     : Drive::Limits::none;
  }
  if (part == 1) r.rest = 0;
  if (d.joint == JointType::spherical) r.cone = d.cone.value_or(kNoCone);
  return r;
}

void start(const LinkDef& d, Model& m) {
  const size_t nq = joint_positions(d.joint), nv = joint_velocities(d.joint);
  std::vector<double> q = d.q;
  if (q.empty()) {
    q.assign(nq, 0.0);
    if (d.joint == JointType::spherical || d.joint == JointType::free) q[nq - 4] = 1;
  }
  m.q.insert(m.q.end(), q.begin(), q.end());
  const auto append = [&](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
    to.resize(to.size() + nv - from.size(), 0.0);
  };
  append(m.v, d.v), append(m.torque, d.torque);
}

}  // namespace

Model build_model(const ArticulationDef& def) {
  Model m;
  std::map<std::string, int32_t> by_id{{"ground", kGround}};
  for (size_t k = 0; k < def.links.size(); ++k) {
    const LinkDef& d = def.links[k];
    m.shapes.push_back(shapes_of(d));
    const MassProperties mass = mass_of(d, m.shapes.back());
    int32_t parent = d.parent ? by_id.at(*d.parent) : static_cast<int32_t>(m.links.size()) - 1;
    const int64_t count = d.copies ? d.copies->count : 1;
    for (int64_t copy = 0; copy < count; ++copy) {
      const std::vector<Part> parts = parts_of(d);
      Link link{d.id,       parent == kGround ? kGround : m.links[size_t(parent)].node,
                parent,     m.tree.velocities,
                0,          k,
                mass.center};
      for (size_t p = 0; p < parts.size(); ++p) {
        Node n;
        n.move = parts[p].move, n.axis = parts[p].axis, n.parent = link.node;
        if (p == 0 && copy == 0) n.frame = {rotation(free_rotation::turn(d.rotation)), d.offset};
        if (p == 0 && copy > 0) n.frame.p = d.copies->offset;
        if (p + 1 == parts.size()) n.inertia = inertia_of(mass);
        link.node = m.tree.add(n);
        m.drives.push_back(drive_of(d, p));
      }
      link.velocities = m.tree.velocities - link.v;
      if (norm2(d.force) + norm2(d.moment) > 0) {
        const bool turning = d.force_frame == LinkDef::Axes::link;
        m.loads.push_back(
            {link.node, mass.center, d.force, d.moment, turning ? Push::Axes::node : Push::Axes::world});
      }
      start(d, m);
      parent = static_cast<int32_t>(m.links.size());
      m.links.push_back(link);
    }
    if (!d.id.empty()) by_id[d.id] = parent;
  }
  const auto node_of = [&](const std::string& id) {
    const int32_t link = by_id.at(id);
    return link == kGround ? kGround : m.links[size_t(link)].node;
  };
  for (const ClosureDef& c : def.closures) {
    m.closures.push_back({node_of(c.a), node_of(c.b), c.point_a, c.point_b});
  }
  for (const LinkSpringDef& s : def.springs) {
    m.springs.push_back(
        {{node_of(s.a), node_of(s.b), s.point_a, s.point_b}, s.stiffness, s.damping, s.rest_length});
  }
  normalise(m.tree, m.q);
  return m;
}

}  // namespace truestep::articulation
