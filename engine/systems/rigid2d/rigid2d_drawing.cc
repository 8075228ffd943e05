// Drawing of a rigid2d state: a prism per shape, attached to the row of its body; contacts and joints as
// marks. Jointed bodies are drawn in different layers, otherwise their faces would flicker.
#include <algorithm>
#include <map>

#include "engine/collision/flat/outline_mesh.h"
#include "engine/systems/rigid2d/rigid2d.h"

namespace truestep::rigid2d {
namespace {

constexpr double kDepth = 0.5;   // of a prism, as a fraction of the size of a typical body
constexpr double kLayer = 0.06;  // from layer to layer

using Motion3 = Visual::Motion;

Motion3 motion_of(const Body& b) {
  if (b.sensor) return Motion3::sensor;
  return b.motion == Motion::fixed       ? Motion3::fixed
         : b.motion == Motion::kinematic ? Motion3::kinematic
                                         : Motion3::dynamic;
}

/// Smallest layers, assigned in the order of the bodies, such that no joint connects two bodies of one layer.
std::vector<uint32_t> layers_of(const Model& m) {
  std::vector<std::vector<uint32_t>> before(m.count());
  for (const Joint& j : m.joints) {
    if (j.a != j.b && std::max(j.a, j.b) < m.count())
      before[std::max(j.a, j.b)].push_back(std::min(j.a, j.b));
  }
  std::vector<uint32_t> layer(m.count());
  for (size_t i = 0; i < layer.size(); ++i) {
    const auto taken = [&](uint32_t l) {
      return std::ranges::any_of(before[i], [&](uint32_t other) { return layer[other] == l; });
    };
    while (taken(layer[i])) ++layer[i];
  }
  return layer;
}

using Key = std::vector<double>;

void describe(Key& key, const Outline& s) {
  key.insert(key.end(), {static_cast<double>(s.corners), s.radius, s.is_link() ? 1.0 : 0.0});
  for (uint32_t i = 0; i < s.corners; ++i) key.insert(key.end(), {s.corner[i].x, s.corner[i].y});
}

/// Equal shapes share a mesh, equal bodies a group.
class Visuals {
 public:
  Visuals(const Model& model, const std::optional<Vec3>& color) : model_(model), color_(color) {}

  uint32_t visual(const Body& body, const Outline& outline, uint32_t layer, uint32_t group) {
    const std::optional<Vec3> color = body.color                       ? body.color
                                      : body.motion == Motion::dynamic ? color_
                                                                       : std::nullopt;
    Key key{static_cast<double>(motion_of(body)), static_cast<double>(layer), static_cast<double>(group)};
    if (color) key.insert(key.end(), {color->x, color->y, color->z});
    describe(key, outline);
    const auto [at, fresh] = visuals_.try_emplace(key, static_cast<uint32_t>(out_.size()));
    if (!fresh) return at->second;
    Visual f;
    f.shape.kind = DrawnShape::Kind::mesh;
    f.shape.mesh = mesh(outline);
    f.shape.position.z = kLayer * model_.size * layer;
    f.motion = motion_of(body), f.group = group;
    if (color) f.color = {color->x, color->y, color->z};
    out_.push_back(f);
    return at->second;
  }
  uint32_t group(const Body& body) {
    Key key;
    for (uint32_t i = 0; i < body.shapes; ++i) describe(key, model_.shapes[body.first_shape + i].outline);
    return groups_.try_emplace(key, static_cast<uint32_t>(groups_.size())).first->second;
  }
  std::vector<Visual> take() { return std::move(out_); }

 private:
  std::shared_ptr<const DrawnMesh> mesh(const Outline& outline) {
    Key key;
    describe(key, outline);
    auto& m = meshes_[key];
    if (!m) m = flat::outline_mesh(outline, kDepth * model_.size);
    return m;
  }
  const Model& model_;
  std::optional<Vec3> color_;
  std::map<Key, uint32_t> visuals_, groups_;
  std::map<Key, std::shared_ptr<const DrawnMesh>> meshes_;
  std::vector<Visual> out_;
};

PartDrawing all_bodies(const Model& m, const std::optional<Vec3>& color) {
  PartDrawing out;
  Visuals visuals(m, color);
  const std::vector<uint32_t> layers = layers_of(m);
  for (uint32_t i = 0; i < m.count(); ++i) {
    const Body& b = m.bodies[i];
    const uint32_t group = b.motion == Motion::dynamic ? visuals.group(b) : 0;
    for (uint32_t k = 0; k < b.shapes; ++k)
      out.instances.push_back({i, visuals.visual(b, m.shapes[b.first_shape + k].outline, layers[i], group)});
  }
  out.visuals = visuals.take();
  return out;
}

Vec3 raised(Vec2 p) {
  return {p.x, p.y, 0};
}

}  // namespace

void Rigid2d::draw(const State& s, double, Wish wishes, Drawing& out) const {
  out.version = drawing_version(s);
  if (wants(wishes, Wish::constant)) {
    std::call_once(drawn_made_, [this] { drawn_ = all_bodies(model_, settings_.color); });
    PartDrawing& bodies = out.parts.emplace_back(drawn_);
    const auto status = s.span<uint32_t>(columns::status);
    std::erase_if(bodies.instances, [&](const auto& i) { return (status[i[0]] & kRemoved) != 0; });
    bodies.space = PartDrawing::Space::plane;
    draw_strings(s, out.strings);
  }
  if (wants(wishes, Wish::contacts)) out.contacts = contact_marks(s);
  if (wants(wishes, Wish::joints)) out.joints = joint_marks(s);
}

// Ropes are drawn at half the depth of the bodies; a pulley's rope runs over its two wheels.
void Rigid2d::draw_strings(const State& s, std::vector<DrawnString>& out) const {
  const auto broken = s.span<uint32_t>(columns::joint_broken), status = s.span<uint32_t>(columns::status);
  const auto gone = [&](uint32_t body) { return body < model_.count() && (status[body] & kRemoved) != 0; };
  const auto end = [&](uint32_t body, Vec2 at) {
    return body < model_.count() ? StringEnd{0, body, raised(at)}
                                 : StringEnd{StringEnd::kWorld, 0, raised(at)};
  };
  const auto fixed = [](Vec2 at) { return StringEnd{StringEnd::kWorld, 0, raised(at)}; };
  for (size_t i = 0; i < model_.joints.size(); ++i) {
    const Joint& j = model_.joints[i];
    if (broken[i] || gone(j.a) || gone(j.b)) continue;
    const StringEnd a = end(j.a, j.local_a), b = end(j.b, j.local_b);
    if (j.kind == JointKind::distance) out.push_back({a, b});
    if (j.kind != JointKind::pulley) continue;
    out.push_back({a, fixed(j.ground_a)});
    out.push_back({fixed(j.ground_a), fixed(j.ground_b)});
    out.push_back({fixed(j.ground_b), b});
  }
}

// Counts removed bodies and broken joints.
uint32_t Rigid2d::drawing_version(const State& s) const {
  const auto removed = std::ranges::count_if(s.span<uint32_t>(columns::status),
                                             [](uint32_t bits) { return (bits & kRemoved) != 0; });
  const auto broken =
      std::ranges::count_if(s.span<uint32_t>(columns::joint_broken), [](uint32_t b) { return b != 0; });
  return static_cast<uint32_t>(1 + removed + broken);
}

std::vector<ContactMark> Rigid2d::contact_marks(const State& s) const {
  std::vector<ContactMark> out;
  const auto keys = s.span<uint64_t>(columns::contact_key);
  const auto ids = s.span<uint32_t>(columns::contact_id);
  const auto impulse = s.span<float>(columns::contact_impulse);
  const double h = settings_for(dt_, substeps(s)).h, front = 0.5 * kDepth * model_.size;
  flat::Contact c;
  for (size_t k = 0; k < keys.size(); ++k) {
    const Shape &a = model_.shapes[keys[k] >> 32], &b = model_.shapes[static_cast<uint32_t>(keys[k])];
    const Pose at = pose_of(s, a.body);
    // The state holds the impulses of the points; their positions are computed again.
    if (!flat::touch(a.outline, b.outline, at.to(pose_of(s, b.body)), model_.margin, c)) continue;
    for (uint32_t p = 0; p < c.points; ++p) {
      for (size_t q = 0; q < 2; ++q) {
        if (ids[2 * k + q] != c.point[p].id || !(impulse[5 * k + q] > 0)) continue;
        out.push_back({raised(at * c.point[p].at) + Vec3{0, 0, front}, raised(at.q * c.normal),
                       impulse[5 * k + q] / h});
      }
    }
  }
  return out;
}

std::vector<JointMark> Rigid2d::joint_marks(const State& s) const {
  using Kind = JointMark::Kind;
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  const Vec3 front{0, 0, 0.5 * kDepth * model_.size};
  const auto pose = [&](uint32_t body) { return body < model_.count() ? pose_of(s, body) : Pose{}; };
  std::vector<JointMark> out;
  for (size_t i = 0; i < model_.joints.size(); ++i) {
    if (broken[i]) continue;
    const size_t first = out.size();
    const Joint& j = model_.joints[i];
    const Pose a = pose(j.a), b = pose(j.b);
    const Vec3 at_a = raised(a * j.local_a) + front, at_b = raised(b * j.local_b) + front;
    const Vec3 along = raised(a.q * j.axis), out_of{0, 0, 1};
    switch (j.kind) {
      case JointKind::revolute:
        out.push_back({Kind::revolute, at_a, at_b, out_of});
        break;
      case JointKind::prismatic:
      case JointKind::wheel:
        out.push_back({Kind::prismatic, at_a, at_b, along});
        break;
      case JointKind::weld:
        out.push_back({Kind::fixed, at_a, at_b, {}});
        break;
      case JointKind::distance:
        out.push_back({Kind::distance, at_a, at_b, {}});
        break;
      case JointKind::mouse:
        out.push_back({Kind::distance, at_b, raised(j.ground_a) + front, {}});
        break;
      case JointKind::pulley:
        out.push_back({Kind::distance, at_a, raised(j.ground_a) + front, {}});
        out.push_back({Kind::distance, raised(j.ground_a) + front, raised(j.ground_b) + front, {}});
        out.push_back({Kind::distance, raised(j.ground_b) + front, at_b, {}});
        break;
      case JointKind::gear:
        out.push_back({Kind::other, raised(a.p) + front, raised(b.p) + front, {}});
        break;
      case JointKind::motor:
        out.push_back({Kind::other, at_a, at_b, {}});
        break;
    }
    for (size_t m = first; m < out.size(); ++m) out[m].row = static_cast<uint32_t>(i), out[m].part = 1;
  }
  return out;
}

}  // namespace truestep::rigid2d
