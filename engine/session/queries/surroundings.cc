#include "engine/session/queries/surroundings.h"

#include <algorithm>

#include "engine/core/ports/ports.h"

namespace truestep {

namespace {

Quat quaternion(const std::array<double, 4>& o) {
  return normalized(Quat{o[0], o[1], o[2], o[3]});
}

Solid solid_of(const DrawnShape& s) {
  using Kind = DrawnShape::Kind;
  switch (s.kind) {
    case Kind::plane:
      return plane_solid(s.size);
    case Kind::box:
      return box_solid(s.size);
    case Kind::sphere:
      return sphere_solid(s.size.x);
    case Kind::capsule:
      return capsule_solid(s.size.x, s.size.y);
    case Kind::cylinder:
      return cylinder_solid(s.size.x, s.size.y);
    case Kind::mesh:
      break;
  }
  std::vector<Vec3> vertices;
  for (size_t i = 0; i + 2 < s.mesh->positions.size(); i += 3)
    vertices.push_back({s.mesh->positions[i], s.mesh->positions[i + 1], s.mesh->positions[i + 2]});
  return mesh_solid(std::move(vertices), s.mesh->triangles);
}

// Whether rows carry all that is there: what such a system draws as obstacles are rows too (planes).
bool has_solids(const Ports& ports) {
  return ports.bodies && !ports.bodies->access();
}

}  // namespace

void Surroundings::gather() {
  if (gathered_) return;
  gathered_ = true;
  const World& world = session_.world();
  FrameRequest request;
  request.wishes = Wish::constant;
  frame_ = session_.frame(request);
  for (size_t p = 0; p < world.parts().size(); ++p) {
    if (world.parts()[p].info().kind == PartInfo::Kind::points) add_part(p);
  }
  for (size_t i = 0; i < world.size(); ++i) {
    if (!has_solids(world.system(i).ports())) add_obstacles(i);
  }
  if (!indexed_) return;
  const std::vector<Mobility> still(items_.size(), Mobility::fixed);
  broad_.update(boxes_, still, 0);
}

void Surroundings::add(Item item) {
  const Vec3& at = item.pose.position;
  const Box box = item.solid ? bounds(*item.solid, transform_of(item.pose)) : Box{at, at};
  item.box = FloatBox::around(box);
  if (indexed_) boxes_.push_back(box);
  items_.push_back(item);
}

void Surroundings::add_obstacles(size_t system) {
  Drawing& drawing = drawn_.emplace_back();
  session_.world().system(system).draw(session_.state().systems[system], session_.time(), Wish::obstacles,
                                       drawing);
  for (const DrawnShape& s : drawing.obstacles) {
    if (s.container) continue;
    own_.push_back(solid_of(s));
    add({&own_.back(), {s.position, quaternion(s.orientation)}, "", s.id, std::nullopt});
  }
}

void Surroundings::add_part(size_t p) {
  const World& world = session_.world();
  const auto& part = world.parts()[p];
  const State& state = session_.state().systems[part.system];
  const std::string_view system = world.id(part.system);
  const Ports ports = world.system(part.system).ports();
  if (part.index == 0 && has_solids(ports)) {
    const ConstBodies bodies(state, *ports.bodies);
    for (size_t k = 0; k < bodies.count(); ++k) {
      if (bodies.form(k).solid)
        add({bodies.form(k).solid, {bodies.place(k), bodies.orientation(k)}, system, part.id, k});
    }
    return;
  }
  std::vector<double> memory, turns;
  const auto position = part.info().find(Meaning::position);
  if (!position) return;
  const FieldView x = part.field(state, *position, memory);
  const auto place = [&](size_t k) {
    return Vec3{element(x, 3 * k), element(x, 3 * k + 1), element(x, 3 * k + 2)};
  };
  const PartDrawing& drawing = frame_->constant->parts[p];
  if (const auto turn = part.info().find(Meaning::orientation); turn && !drawing.instances.empty()) {
    const FieldView q = part.field(state, *turn, turns);
    for (const Visual& visual : drawing.visuals) own_.push_back(solid_of(visual.shape));
    const size_t first = own_.size() - drawing.visuals.size();
    for (const auto& [row, which] : drawing.instances) {
      if (row >= x.rows || row >= q.rows || which >= drawing.visuals.size()) continue;
      const Quat body = normalized(Quat{element(q, 4 * row), element(q, 4 * row + 1), element(q, 4 * row + 2),
                                        element(q, 4 * row + 3)});
      const DrawnShape& shape = drawing.visuals[which].shape;
      const Vec3 at = place(row) + rotation(body).apply(shape.position);
      add({&own_[first + which], {at, body * quaternion(shape.orientation)}, system, part.id, row});
    }
    return;
  }
  const Solid* ball = nullptr;
  if (drawing.point_radius > 0) ball = &own_.emplace_back(sphere_solid(drawing.point_radius));
  for (size_t k = 0; k < x.rows; ++k) add({ball, {place(k), {}}, system, part.id, k});
}

}  // namespace truestep
