// Drawing of a rigid3d state: one visual per shape, or per part of a compound, attached to rows of the state;
// planes as shapes in space; contacts and joints as marks.
#include <map>

#include "engine/collision/drawn_mesh.h"
#include "engine/geometry/triangle_mesh.h"
#include "engine/systems/rigid3d/rigid3d.h"

namespace truestep::rigid3d {

namespace {

constexpr double kLoose = 0.02;  // m; points further apart than this are no longer contacts

Visual::Motion motion_of(const BodyKind& k) {
  using Motion = Visual::Motion;
  if (k.sensor) return Motion::sensor;
  if (k.motion == BodyDef::Motion::fixed) return Motion::fixed;
  return k.motion == BodyDef::Motion::kinematic ? Motion::kinematic : Motion::dynamic;
}

/// The numbers that equal solids have in common.
void describe(std::vector<double>& key, const Solid& s) {
  key.insert(key.end(), {static_cast<double>(s.kind), s.size.x, s.size.y, s.size.z});
  if (s.hull) key.insert(key.end(), {static_cast<double>(s.hull->vertices.size()), s.hull->thickness});
  if (s.mesh) key.push_back(static_cast<double>(s.mesh->size()));
}

std::vector<Visual> visuals_of(std::span<const BodyKind> kinds) {
  std::vector<Visual> visuals;
  std::map<std::vector<double>, uint32_t> groups;
  for (const BodyKind& k : kinds) {
    if (k.solid.kind == SolidKind::plane) continue;
    Visual visual;
    visual.motion = motion_of(k);
    if (k.color) visual.color = {k.color->x, k.color->y, k.color->z};
    // Fixed bodies use none of the colours of dynamic ones.
    if (visual.motion == Visual::Motion::dynamic && !k.color) {
      std::vector<double> key;
      describe(key, k.solid);
      for (const SolidPart& p : k.parts) describe(key, p.solid);
      visual.group = groups.try_emplace(key, static_cast<uint32_t>(groups.size())).first->second;
    }
    const auto add = [&](const Solid& solid, const Pose& at) {
      visual.shape = drawn_shape(solid, at);
      visual.shape.id = k.id;
      visuals.push_back(visual);
    };
    if (k.parts.empty()) add(k.solid, {});
    for (const SolidPart& p : k.parts) add(p.solid, p.pose);
  }
  return visuals;
}

JointMark mark_of(const Joint& j, const Pose& a, const Pose& b) {
  using Kind = JointMark::Kind;
  const JointPlace at = joint_place(j, a, b);
  JointMark mark{.kind = Kind::other, .a = a.position + at.arm_a, .b = b.position + at.arm_b, .axis = {}};
  const int slides = 3 - j.locked[0] - j.locked[1] - j.locked[2];
  const int turns = 3 - j.locked[3] - j.locked[4] - j.locked[5];
  if (j.form == Joint::Form::line) {
    mark.kind = Kind::distance;
  } else if (slides == 0) {
    mark.kind = turns == 0 ? Kind::fixed : j.form == Joint::Form::hinge ? Kind::revolute : Kind::spherical;
    if (mark.kind == Kind::revolute) mark.axis = normalized(at.turns[0], {});
  } else if (slides == 1) {
    mark.kind = Kind::prismatic;
    for (size_t e = 0; e < 3; ++e) {
      if (!j.locked[e]) mark.axis = at.axes[e];
    }
  }
  return mark;
}

}  // namespace

const std::vector<Visual>& Rigid3d::visuals() const {
  std::call_once(visuals_made_, [this] { visuals_ = visuals_of(bodies_.kinds); });
  return visuals_;
}

void Rigid3d::draw(const State& s, double, Wish wishes, Drawing& out) const {
  out.version = drawing_version(s);
  if (wants(wishes, Wish::constant)) {
    out.parts.resize(parts().size());
    draw_bodies(s, out.parts[0]);
    draw_strings(s, out.strings);
  }
  if (wants(wishes, Wish::obstacles)) out.obstacles = planes(s);
  if (wants(wishes, Wish::contacts)) out.contacts = contact_marks(s);
  if (wants(wishes, Wish::joints)) out.joints = joint_marks(s);
}

void Rigid3d::draw_bodies(const State& s, PartDrawing& out) const {
  out.visuals = visuals();
  // In the order of the kinds, one per part.
  std::vector<uint32_t> first;
  uint32_t next = 0;
  const auto count = [](const BodyKind& k) {
    if (k.solid.kind == SolidKind::plane) return 0u;
    return k.parts.empty() ? 1u : static_cast<uint32_t>(k.parts.size());
  };
  for (const BodyKind& k : bodies_.kinds) first.push_back(next), next += count(k);
  const auto kind = s.span<uint32_t>(columns::kind);
  for (uint32_t row = 0; row < kind.size(); ++row) {
    for (uint32_t k = 0; k < count(bodies_.kinds[kind[row]]); ++k)
      out.instances.push_back({row, first[kind[row]] + k});
  }
}

void Rigid3d::draw_strings(const State& s, std::vector<DrawnString>& out) const {
  const auto held = s.span<uint32_t>(columns::joint_bodies), broken = s.span<uint32_t>(columns::joint_broken);
  const auto end = [](uint32_t row, const Vec3& at) {
    return row == kNoBody ? StringEnd{StringEnd::kWorld, 0, at} : StringEnd{0, row, at};
  };
  for (size_t k = 0; k < joints_.joints.size(); ++k) {
    const Joint& j = joints_.joints[k];
    if (j.form != Joint::Form::line || broken[k]) continue;
    out.push_back({end(held[2 * k], j.anchor_a), end(held[2 * k + 1], j.anchor_b)});
  }
}

// Counts births, removals and broken joints: births = next id - n_0, removals = next id - rows.
uint32_t Rigid3d::drawing_version(const State& s) const {
  const uint64_t next = s.span<uint64_t>(columns::counters)[0];
  const auto broken = s.span<uint32_t>(columns::joint_broken);
  const auto breaks = static_cast<size_t>(std::ranges::count_if(broken, [](uint32_t b) { return b != 0; }));
  return static_cast<uint32_t>(1 + 2 * next - bodies_.starts.size() - s.rows(columns::position) + breaks);
}

std::vector<DrawnShape> Rigid3d::planes(const State& s) const {
  std::vector<DrawnShape> out;
  const auto kind = s.span<uint32_t>(columns::kind);
  for (size_t i = 0; i < kind.size(); ++i) {
    const BodyKind& b = bodies_.kinds[kind[i]];
    if (b.solid.kind != SolidKind::plane) continue;
    DrawnShape& d =
        out.emplace_back(drawn_shape(b.solid, {load3(s.f64(columns::position).data(), i),
                                               load_quat(s.f64(columns::orientation).data(), i)}));
    d.id = b.id.empty() ? std::to_string(i) : b.id;
  }
  return out;
}

std::vector<ContactMark> Rigid3d::contact_marks(const State& s) const {
  std::vector<ContactMark> out;
  const double h = s.f64(columns::substep)[0];
  if (!(h > 0)) return out;
  const auto pairs = s.span<uint32_t>(columns::contact_bodies);
  const auto ids = s.span<uint32_t>(columns::contact_ids);
  const auto impulse = s.f64(columns::contact_impulse);
  const auto kind = s.span<uint32_t>(columns::kind);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  const auto placed = [&](uint32_t i) { return transform_of({load3(x, i), load_quat(q, i)}); };
  std::vector<Manifold> manifolds;
  const size_t rows = s.rows(columns::contact_bodies);
  for (size_t begin = 0, end = 0; begin < rows; begin = end) {
    const uint32_t a = pairs[2 * begin], b = pairs[2 * begin + 1];
    for (end = begin; end < rows && pairs[2 * end] == a && pairs[2 * end + 1] == b;) ++end;
    // The state holds the loads of the points; their positions are computed again.
    manifolds.clear();
    const Solid &sa = bodies_.kinds[kind[a]].solid, &sb = bodies_.kinds[kind[b]].solid;
    if (is_convex_or_plane(sa.kind) && is_convex_or_plane(sb.kind)) {
      Manifold& m = manifolds.emplace_back();
      if (!collide(sa, placed(a), sb, placed(b), kLoose, m)) manifolds.clear();
    } else {
      collide(sa, placed(a), sb, placed(b), kLoose, manifolds);
    }
    for (const Manifold& m : manifolds) {
      for (int p = 0; p < m.count; ++p) {
        double carried = 0;
        for (size_t r = begin; r < end; ++r) {
          for (uint32_t k = 0; k < ids[5 * r] && carried == 0; ++k) {
            if (ids[5 * r + 1 + k] == m.points[p].id) carried = impulse[4 * r + k];
          }
        }
        if (carried > 0) out.push_back({m.points[p].position, m.normal, carried / h});
      }
    }
  }
  return out;
}

std::vector<JointMark> Rigid3d::joint_marks(const State& s) const {
  std::vector<JointMark> out;
  const auto held = s.span<uint32_t>(columns::joint_bodies);
  const double *x = s.f64(columns::position).data(), *q = s.f64(columns::orientation).data();
  const auto pose = [&](uint32_t i) { return i == kNoBody ? Pose{} : Pose{load3(x, i), load_quat(q, i)}; };
  for (size_t k = 0; k < joints_.joints.size(); ++k) {
    // A gear has no position of its own: it couples two other joints.
    if (s.span<uint32_t>(columns::joint_broken)[k] || joints_.joints[k].form == Joint::Form::gear) continue;
    out.push_back(mark_of(joints_.joints[k], pose(held[2 * k]), pose(held[2 * k + 1])));
    out.back().row = static_cast<uint32_t>(k), out.back().part = 1;
  }
  return out;
}

}  // namespace truestep::rigid3d
