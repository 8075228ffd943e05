#include "engine/systems/rigid2d/flat_bodies.h"

#include <algorithm>
#include <optional>

#include "engine/systems/rigid2d/columns.h"

namespace truestep::rigid2d {
namespace {

/// Number of sides that approximate a round surface.
constexpr int kSides = 32;
/// Depth of a prism in each direction, as a multiple of the body's reach.
constexpr double kBodyDepth = 2;
/// Maps x to y, y to z, z to x without rounding: turns the axis of a capsule from y to z.
constexpr Quat kAlongZ{0.5, 0.5, 0.5, 0.5};

struct Surface3 {
  std::vector<Vec3> vertices;
  std::vector<uint32_t> triangles;

  /// A wall along z from a to b; its outer face is on the left of that direction.
  void wall(Vec2 a, Vec2 b, double depth) {
    const auto first = static_cast<uint32_t>(vertices.size());
    for (const Vec2 p : {a, b}) {
      for (const double z : {-depth, depth}) vertices.push_back({p.x, p.y, z});
    }
    for (const uint32_t k : {0u, 1u, 3u, 0u, 3u, 2u}) triangles.push_back(first + k);
  }
};

Vec2 farthest(const Outline& s, Vec2 direction) {
  Vec2 best = s.corner[0];
  for (uint32_t i = 1; i < s.corners; ++i) {
    if (flat::dot(s.corner[i], direction) > flat::dot(best, direction)) best = s.corner[i];
  }
  return best + s.radius * direction;
}

std::optional<Solid> surface(std::span<const Shape> shapes, double depth) {
  Surface3 out;
  for (const Shape& shape : shapes) {
    const Outline& s = shape.outline;
    if (s.is_link()) {
      out.wall(s.corner[0], s.corner[1], depth);
      if (s.side == Outline::Side::both) out.wall(s.corner[1], s.corner[0], depth);
      continue;
    }
    Vec2 before = farthest(s, {1, 0});
    for (int k = 1; k <= kSides; ++k) {
      const auto [sin, cos] = trig::sincos(6.283185307179586 * (k % kSides) / kSides);
      const Vec2 next = farthest(s, {cos, sin});
      if (!(next == before)) out.wall(next, before, depth);
      before = next;
    }
  }
  if (out.triangles.empty()) return std::nullopt;
  return mesh_solid(std::move(out.vertices), std::move(out.triangles));
}

/// The rounded polygon: its flat sides as one prism, its corners as capsules.
void add_prisms(const Outline& s, double depth, std::vector<SolidPart>& out) {
  if (s.radius > 0) {
    for (uint32_t i = 0; i < s.corners; ++i) {
      out.push_back({capsule_solid(s.radius, depth), {{s.corner[i].x, s.corner[i].y, 0}, kAlongZ}});
    }
  }
  if (s.corners == 1) return;
  std::vector<Vec3> points;
  for (uint32_t i = 0; i < s.corners; ++i) {
    for (const Vec2 n : {s.normal[(i + s.corners - 1) % s.corners], s.normal[i]}) {
      const Vec2 p = s.corner[i] + s.radius * n;
      for (const double z : {-depth, depth}) points.push_back({p.x, p.y, z});
      if (s.radius == 0) break;
    }
  }
  out.push_back({hull_solid(points), {}});
}

std::optional<Solid> solid_of(const Body& b, std::span<const Shape> shapes) {
  if (shapes.empty() || b.sensor) return std::nullopt;
  const double depth = kBodyDepth * b.reach;
  if (std::ranges::any_of(shapes, [](const Shape& s) { return s.outline.is_link(); })) {
    return surface(shapes, depth);
  }
  std::vector<SolidPart> parts;
  for (const Shape& s : shapes) add_prisms(s.outline, depth, parts);
  return compound_solid(std::move(parts));
}

}  // namespace

FlatBodies::FlatBodies(const Model& model) : model_(model), forms_(2 * model.count() + 1) {
  const size_t n = model.count();
  for (size_t i = 0; i < n; ++i) {
    const Body& b = model.bodies[i];
    const std::span<const Shape> shapes(model.shapes.data() + b.first_shape, b.shapes);
    const auto solid = solid_of(b, shapes);
    BodyForm& form = forms_[i];
    if (solid) form.solid = &solids_.emplace_back(*solid);
    forms_[n + i] = form;
    form.mass = b.motion == Motion::dynamic ? b.mass : 0, form.moments = {0, 0, b.inertia};
  }
}

uint32_t FlatBodies::form(const State& s, size_t row) const {
  const uint32_t status = s.span<uint32_t>(columns::status)[row];
  const auto n = static_cast<uint32_t>(model_.count()), i = static_cast<uint32_t>(row);
  return status & kRemoved ? 2 * n : status & kPinned ? n + i : i;
}

BodyMotion FlatBodies::motion(const State& s, size_t row) const {
  const trig::SinCos half = trig::sincos(0.5 * s.f64(columns::angle)[row]);
  const Vec3 x = load3(s.f64(columns::position).data(), row), v = load3(s.f64(columns::velocity).data(), row);
  return {{x.x, x.y, 0},
          {half.cos, 0, 0, half.sin},
          {v.x, v.y, 0},
          {0, 0, s.f64(columns::angular_velocity)[row]}};
}

void FlatBodies::motions(const State& s, std::span<BodyMotion> out, Workspace&) const {
  for (size_t i = 0; i < out.size(); ++i) out[i] = motion(s, i);
}

BodyTwist FlatBodies::answer(const State& s, size_t row, const BodyImpulse& on) const {
  if (model_.bodies[row].motion != Motion::dynamic ||
      (s.span<uint32_t>(columns::status)[row] & (kPinned | kRemoved))) {
    return {};
  }
  const Dynamics& d = model_.dynamics[row];
  return {{on.impulse.x * d.inverse_mass, on.impulse.y * d.inverse_mass, 0},
          {0, 0, on.twist.z * d.inverse_inertia}};
}

BodyTwist FlatBodies::answer(const State& s, size_t row, const BodyImpulse& on, Workspace&) const {
  return answer(s, row, on);
}

void FlatBodies::answers(const State& s, std::span<const BodyImpulse> on, std::span<BodyTwist> out,
                         Workspace&) const {
  for (size_t i = 0; i < on.size(); ++i) out[i] = answer(s, i, on[i]);
}

void FlatBodies::wake(State& s, size_t row) const {
  s.f64(columns::sleep_timer)[row] = 0;
  if (!is_asleep(model_.light[row], s.span<uint32_t>(columns::status)[row])) return;
  std::vector<uint8_t> seeds(model_.count());
  seeds[row] = 1;
  wake_islands(model_, s, seeds);
}

void FlatBodies::push(State& s, size_t row, const BodyImpulse& on, Workspace&) const {
  wake(s, row);
  const BodyTwist by = answer(s, row, on);
  double* v = s.f64(columns::velocity).data();
  store3(v, row, load3(v, row) + by.velocity);
  s.f64(columns::angular_velocity)[row] += by.spin.z;
}

void FlatBodies::shift(State& s, size_t row, const BodyImpulse& by, const Vec3& gained, Workspace&) const {
  const BodyTwist way = answer(s, row, by);
  double* x = s.f64(columns::position).data();
  store3(x, row, load3(x, row) + way.velocity);
  s.f64(columns::angle)[row] += way.spin.z;
  s.f64(columns::angular_velocity)[row] -= gained.z * model_.dynamics[row].inverse_inertia;
}

}  // namespace truestep::rigid2d
