#include "engine/systems/keyframes/keyframes.h"

#include "engine/core/commands/command_checks.h"

namespace truestep::keyframes {

using animation::MovedBodies;
using enum MovedColumns::Index;

namespace {

constexpr auto kBodies = MovedColumns::kBodies;

Solid solid_of(const MovedShapeDef& d) {
  switch (d.shape) {
    case ShapeType::sphere:
      return sphere_solid(d.radius);
    case ShapeType::box:
      return box_solid(d.half_extents);
    case ShapeType::capsule:
      return capsule_solid(d.radius, d.half_length);
    case ShapeType::cylinder:
      break;
  }
  return cylinder_solid(d.radius, d.half_length);
}

DrawnShape drawn(const MovedShapeDef& d) {
  DrawnShape out;
  using Kind = DrawnShape::Kind;
  constexpr Kind kKinds[] = {Kind::sphere, Kind::box, Kind::capsule, Kind::cylinder};
  out.kind = kKinds[static_cast<size_t>(d.shape)];
  out.size = d.shape == ShapeType::box ? d.half_extents : Vec3{d.radius, d.half_length, 0};
  out.id = d.id;
  return out;
}

/// A sphere made of rings about y, from pole to pole.
void make_ball(double radius, std::vector<Vec3>& x, std::vector<std::array<uint32_t, 3>>& triangles) {
  constexpr uint32_t kAround = 24, kRings = 15;
  const auto first = static_cast<uint32_t>(0);
  x.push_back({0, radius, 0});
  for (uint32_t r = 1; r <= kRings; ++r) {
    const auto [sin, cos] = trig::sincos(3.141592653589793 * r / (kRings + 1));
    for (uint32_t k = 0; k < kAround; ++k) {
      const auto [s, c] = trig::sincos(6.283185307179586 * k / kAround);
      x.push_back({radius * sin * c, radius * cos, radius * sin * s});
    }
  }
  x.push_back({0, -radius, 0});
  const auto last = static_cast<uint32_t>(x.size() - 1);
  const auto at = [&](uint32_t ring, uint32_t k) { return first + 1 + (ring - 1) * kAround + k % kAround; };
  for (uint32_t k = 0; k < kAround; ++k) {
    triangles.push_back({first, at(1, k + 1), at(1, k)});
    for (uint32_t r = 1; r < kRings; ++r) {
      triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k)});
      triangles.push_back({at(r, k + 1), at(r + 1, k + 1), at(r + 1, k)});
    }
    triangles.push_back({at(kRings, k), at(kRings, k + 1), last});
  }
}

void make_box(const Vec3& half, std::vector<Vec3>& x, std::vector<std::array<uint32_t, 3>>& triangles) {
  for (int k = 0; k < 8; ++k) {
    x.push_back({k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z});
  }
  constexpr uint32_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& f : kFaces) {
    triangles.push_back({f[0], f[1], f[2]});
    triangles.push_back({f[0], f[2], f[3]});
  }
}

}  // namespace

struct Keyframes::Scratch {
  animation::Driver::Scratch driver;
  std::vector<double> skin;
};

Keyframes::Keyframes(const KeyframesDef& def, const BuildContext& context)
    : driver_(def, context.id), dt_(context.dt) {
  for (size_t k = 0; k < def.shapes.size(); ++k) add_shape(def.shapes[k], k);
  driver_.finish();
  for (const Solid& s : solids_) forms_.push_back({&s, 0, {}});
  for (size_t k = 0; k < shapes_.size(); ++k) {
    if (!shapes_[k].vertices.empty()) forms_[k].solid = nullptr;
  }
  add_stage("keys",
            std::to_string(driver_.controls()) + " controls, " + std::to_string(shapes_.size()) + " shapes" +
                (def.frame_rate ? "; held between frames" : ""),
            [this](State& s, const StepInput& in) {
              update(s, in.t + in.h, in.h, in.workspace.object<Scratch>("keyframes"));
            });
  if (stretched_.empty()) skip_stage("surfaces", "no shape is stretched");
  show();
  set_remedies({"expressions that stay finite at every time"});
}

void Keyframes::add_shape(const MovedShapeDef& d, size_t number) {
  const std::string at = "/shapes/" + std::to_string(number);
  Shape s;
  s.def = d;
  s.position = driver_.add_vector(at + "/position", d.position);
  if (d.turn.empty()) {
    s.rotation = driver_.add_vector(at + "/rotation", d.rotation);
  } else {
    s.turn = driver_.turn(at + "/turn", d.turn);
  }
  if (!d.scale.empty()) {
    std::vector<std::string> scale = d.scale;
    scale.resize(3, "1");
    s.scale = driver_.add_vector(at + "/scale", scale);
    std::vector<std::array<uint32_t, 3>> triangles;
    if (d.shape == ShapeType::box) {
      make_box(d.half_extents, s.vertices, triangles);
    } else {
      make_ball(d.radius, s.vertices, triangles);
    }
    for (const Shape& other : shapes_) {
      if (other.def.id != d.id) continue;
      driver_.fault({at + "/id", "duplicate_name", "another shape has this name", d.id, "", "", ""});
    }
    s.first_vertex = vertices_;
    for (auto t : triangles) {
      for (uint32_t& v : t) v += static_cast<uint32_t>(vertices_);
      triangles_.push_back(t);
    }
    vertices_ += s.vertices.size();
    stretched_.push_back(shapes_.size());
  } else {
    rigid_ = true;
  }
  if (!d.id.empty()) named_.push_back(shapes_.size());
  solids_.push_back(solid_of(d));
  shapes_.push_back(std::move(s));
}

State Keyframes::initial_state() const {
  State s;
  MovedBodies::add(s, "", shapes_.size());
  driver_.add_column(s);
  s.add({"skin.position", "m", Scalar::f64, 3, Role::position}, vertices_);
  s.add({"skin.velocity", "m/s", Scalar::f64, 3, Role::velocity}, vertices_);
  s.add({"skin.inverse_mass", "1/kg"}, vertices_);
  s.add({"value", "1"}, driver_.controls());
  Scratch scratch;
  update(s, 0, 0, scratch);
  // The velocities at the start are those of the first step.
  State ahead = s;
  update(ahead, dt_, dt_, scratch);
  for (const State::Column c : {kBodies.velocity, kBodies.angular_velocity, State::Column{kSkinVelocity}}) {
    s.copy_column(c, ahead, c);
  }
  return s;
}

void Keyframes::update(State& s, double t, double h, Scratch& scratch) const {
  const auto out = driver_.evaluate(t, s.f64(kControl), scratch.driver);
  std::copy_n(scratch.driver.variables.begin() + 1, driver_.controls(), s.f64(kValue).begin());
  scratch.skin.resize(3 * vertices_);
  for (size_t k = 0; k < shapes_.size(); ++k) {
    const Shape& shape = shapes_[k];
    const Vec3 angles = shape.turn ? Vec3{} : load3(&out[shape.rotation], 0);
    const Pose pose{load3(&out[shape.position], 0), shape.turn
                                                        ? driver_.turn_at(*shape.turn, t)
                                                        : animation::euler_rotation(shape.def.order, angles)};
    kBodies.place(s, k, pose, h);
    if (shape.vertices.empty()) continue;
    const Vec3 scale = load3(&out[shape.scale], 0);
    const Rotation r = rotation(pose.orientation);
    for (size_t i = 0; i < shape.vertices.size(); ++i) {
      const Vec3& x = shape.vertices[i];
      store3(scratch.skin.data(), shape.first_vertex + i,
             pose.position + r.apply({scale.x * x.x, scale.y * x.y, scale.z * x.z}));
    }
  }
  animation::place_points(s.f64(kSkin), s.f64(kSkinVelocity), std::span(scratch.skin).first(3 * vertices_),
                          h);
}

void Keyframes::apply(State& s, const Command& c) const {
  check_command_numbers(c);
  if (c.kind != CommandKind::set_parameter) {
    refuse_command("type", "unsupported_command", "shapes of keyframes move as prescribed", "set_parameter");
  }
  if (driver_.apply(s, kControl, c)) return;
  std::string all;
  for (size_t k = 0; k < driver_.controls(); ++k) all += (k > 0 ? ", " : "") + driver_.control(k);
  refuse_command("name", "unknown_parameter", "there is no control \"" + c.name + "\"", all);
}

void Keyframes::draw(const State&, double, Wish wishes, Drawing& out) const {
  if (!wants(wishes, Wish::constant)) return;
  out.parts.resize(parts().size());
  const auto color = [](const MovedShapeDef& d) -> std::optional<std::array<double, 3>> {
    if (!d.color) return std::nullopt;
    return std::array{d.color->x, d.color->y, d.color->z};
  };
  for (size_t k = 0; k < shapes_.size(); ++k) {
    const Shape& shape = shapes_[k];
    if (!shape.vertices.empty()) continue;
    Visual v{.shape = drawn(shape.def), .color = color(shape.def), .motion = Visual::Motion::kinematic};
    out.parts[0].instances.push_back(
        {static_cast<uint32_t>(k), static_cast<uint32_t>(out.parts[0].visuals.size())});
    out.parts[0].visuals.push_back(std::move(v));
  }
  for (size_t p = 0; p < stretched_.size(); ++p) {
    const Shape& shape = shapes_[stretched_[p]];
    PartDrawing& drawing = out.parts[p + 1];
    drawing.color = color(shape.def);
    const auto first = static_cast<uint32_t>(shape.first_vertex);
    const auto end = first + static_cast<uint32_t>(shape.vertices.size());
    for (const auto& t : triangles_) {
      if (t[0] >= first && t[0] < end)
        drawing.triangles.push_back({t[0] - first, t[1] - first, t[2] - first});
    }
  }
}

Ports Keyframes::ports() const {
  Ports out;
  out.driver = &driver_;
  if (rigid_) {
    out.bodies = kBodies.port(forms_);
  } else if (vertices_ > 0) {
    out.points = PointPort{.position = kSkin,
                           .velocity = kSkinVelocity,
                           .mass = std::nullopt,
                           .inverse_mass = kSkinInverseMass,
                           .id = std::nullopt,
                           .radius = 0};
    out.solids = {triangles_, {}};
  }
  return out;
}

std::unique_ptr<const System> build_keyframes(const void* def, const BuildContext& context) {
  return std::make_unique<Keyframes>(*static_cast<const KeyframesDef*>(def), context);
}

}  // namespace truestep::keyframes
