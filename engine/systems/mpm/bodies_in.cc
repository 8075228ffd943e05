#include "engine/systems/mpm/bodies_in.h"

#include <cmath>
#include <optional>

#include "engine/collision/point_distance.h"

namespace truestep::mpm {

namespace {

/// Distance from p, if it is inside, to the solid's surface. For a closed mesh the search radius for the
/// nearest triangle doubles until one is found; an open sheet has no inside.
std::optional<PointDistance> inside(const Solid& solid, const Vec3& p, double cell) {
  if (solid.kind != SolidKind::mesh) return point_distance(solid, p, 0);
  const MeshSides sides = mesh_sides(solid);
  if (sides == MeshSides::front) return std::nullopt;
  const double most = 2 * bounding_radius(solid);
  for (double reach = cell;; reach *= 2) {
    const auto near = point_distance(solid, p, reach, sides);
    if (near || reach > most) return near;
  }
}

}  // namespace

void BodiesIn::begin(std::span<const ImmersedBody> given, double cell) {
  bodies_.assign(given.begin(), given.end());
  // Room for the nodes of the largest body, so that no later step allocates.
  double most = 0;
  for (const ImmersedBody& b : bodies_) most = std::max(most, 2 * bounding_radius(*b.solid) / cell + 2);
  const auto room = static_cast<size_t>(std::min(most * most * most, kMostRoom));
  nodes_.reserve(room), handles_.reserve(room), trial_.reserve(bodies_.size());
}

double BodiesIn::fastest() const {
  double out = 0;
  for (const ImmersedBody& b : bodies_)
    out = std::max(out, norm(b.velocity) + norm(b.spin) * bounding_radius(*b.solid));
  return out;
}

double BodiesIn::push(const MpmDef& def, const Vec3& gravity, double h, Visit visit, Settle settle) {
  trial_ = bodies_;
  double fastest = 0;
  for (ImmersedBody& b : trial_) {
    if (b.mass > 0) {
      // A stronger pull is an impact, which does not last.
      const bool steady = b.pull && norm2(*b.pull) <= kSteady * norm2(gravity);
      b.velocity += (steady ? *b.pull : gravity) * h;
    }
    const Transform frame = b.frame();
    nodes_.clear(), handles_.clear();
    visit(bounds(*b.solid, frame), [&](const Vec3& x, double mass, const Vec3& v, size_t handle) {
      const auto near = inside(*b.solid, frame.inverse_point(x), def.cell);
      if (!near || near->distance >= 0) return;
      nodes_.push_back({mass, x - b.place, frame.direction(near->normal), v, {}, false});
      handles_.push_back(handle);
    });
    if (nodes_.empty()) continue;
    const auto momentum_of = [&](const Vec3& spin) {
      return free_rotation::momentum({b.orientation, spin}, b.moments);
    };
    TouchedBody body{
        b.mass, {momentum_of({1, 0, 0}), momentum_of({0, 1, 0}), momentum_of({0, 0, 1})}, b.velocity, b.spin};
    touch(nodes_, body, static_cast<Hold>(def.contact), def.body_friction);
    Vec3 impulse, twist;
    for (size_t k = 0; k < nodes_.size(); ++k) {
      // The change left after walls and rounding.
      const Vec3 got = settle(handles_[k], nodes_[k].velocity) * nodes_[k].mass;
      impulse -= got, twist -= cross(nodes_[k].arm, got);
      fastest = std::max(fastest, norm2(nodes_[k].velocity));
    }
    b.give(impulse, twist);
  }
  return std::sqrt(fastest);
}

void BodiesIn::accept(double h) {
  bodies_.swap(trial_);
  for (ImmersedBody& b : bodies_) b.advance(h);
}

}  // namespace truestep::mpm
