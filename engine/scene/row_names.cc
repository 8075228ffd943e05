#include "engine/scene/row_names.h"

#include "engine/systems/articulation/articulation_def.h"
#include "engine/systems/rigid2d/rigid2d_def.h"
#include "engine/systems/rigid3d/rigid3d_def.h"

namespace truestep {

namespace {

RowNames names_of(const rigid3d::Rigid3dDef& d) {
  RowNames out{.bodies_are = RowNames::BodiesAre::forms};
  for (size_t k = 0; k < d.bodies.size(); ++k) {
    if (const std::string& id = rigid3d::common(d.bodies[k]).id; !id.empty()) out.bodies.push_back({id, k});
  }
  size_t row = 0;
  for (const rigid3d::AnyJointDef& j : d.joints) {
    const std::string& id = rigid3d::joint_id(j);
    const auto n = static_cast<size_t>(rigid3d::joint_count(j));
    // As observables call the further ones of an entry that repeats.
    for (size_t k = 0; k < n && !id.empty(); ++k)
      out.joints.push_back({k == 0 ? id : id + "." + std::to_string(k), row + k});
    row += n;
  }
  return out;
}

// Listed bodies come before those of generators, listed joints after them.
RowNames names_of(const rigid2d::Rigid2dDef& d, size_t joints) {
  RowNames out;
  for (size_t k = 0; k < d.bodies.size(); ++k) {
    if (!d.bodies[k].id.empty()) out.bodies.push_back({d.bodies[k].id, k});
  }
  const size_t generated = joints - std::min(joints, d.joints.size());
  for (size_t k = 0; k < d.joints.size(); ++k) {
    const auto& id = std::visit([](const auto& j) -> const std::string& { return j.id; }, d.joints[k]);
    if (!id.empty()) out.joints.push_back({id, generated + k});
  }
  return out;
}

// Of a link with copies the last, as for its children.
RowNames names_of(const articulation::ArticulationDef& d) {
  RowNames out;
  size_t row = 0;
  for (const articulation::LinkDef& l : d.links) {
    row += l.copies ? static_cast<size_t>(l.copies->count) : 1;
    if (!l.id.empty()) out.bodies.push_back({l.id, row - 1});
  }
  return out;
}

}  // namespace

RowNames row_names(const SceneSystem& system, size_t joints) {
  const DefTable* table = system.row->table;
  if (table == &rigid3d::rigid3d_table())
    return names_of(*static_cast<const rigid3d::Rigid3dDef*>(system.def.get()));
  if (table == &rigid2d::rigid2d_table())
    return names_of(*static_cast<const rigid2d::Rigid2dDef*>(system.def.get()), joints);
  if (table == &articulation::articulation_table())
    return names_of(*static_cast<const articulation::ArticulationDef*>(system.def.get()));
  return {};
}

std::vector<FirstRow> first_rows(const SceneSystem& system) {
  std::vector<FirstRow> out;
  if (system.row->table == &rigid3d::rigid3d_table()) {
    size_t row = 0;
    for (const rigid3d::AnyBodyDef& b : static_cast<const rigid3d::Rigid3dDef*>(system.def.get())->bodies) {
      const rigid3d::BodyDef& body = rigid3d::common(b);
      const auto n = static_cast<size_t>(rigid3d::body_count(body));
      if (!body.id.empty()) out.push_back({body.id, row, n});
      row += n;
    }
    return out;
  }
  for (NamedRow& n : row_names(system, 0).bodies) out.push_back({std::move(n.id), n.row, 1});
  return out;
}

}  // namespace truestep
