// Rigid bodies in the material (core/ports/medium.h): nodes inside a body and the body push each other
// (kernels/mpm/touch.h), with equal and opposite impulses. Nodes do not see a body thinner than a cell or
// two.
#pragma once
#include <vector>

#include "engine/collision/point_distance.h"
#include "engine/core/ports/medium.h"
#include "engine/kernels/mpm/touch.h"
#include "engine/systems/mpm/solver.h"

namespace truestep::mpm {

class BodiesIn {
 public:
  void begin(std::span<const ImmersedBody> given, double cell) {
    bodies_.assign(given.begin(), given.end());
    // Room for the nodes of the largest body, so that no later step allocates.
    double most = 0;
    for (const ImmersedBody& b : bodies_) most = std::max(most, 2 * bounding_radius(*b.solid) / cell + 2);
    const auto room = static_cast<size_t>(std::min(most * most * most, kMostRoom));
    nodes_.reserve(room), handles_.reserve(room), trial_.reserve(bodies_.size());
  }
  void end(std::span<ImmersedBody> given) const { std::copy(bodies_.begin(), bodies_.end(), given.begin()); }
  bool any() const { return !bodies_.empty(); }

  /// m/s, of the fastest point of any body.
  double fastest() const {
    double out = 0;
    for (const ImmersedBody& b : bodies_)
      out = std::max(out, norm(b.velocity) + norm(b.spin) * bounding_radius(*b.solid));
    return out;
  }

  /// Exchanges impulses between nodes and bodies for a substep that may still be rejected. visit(box, f)
  /// calls f(place, mass, velocity, handle) for every node with mass in the box; settle(handle, velocity)
  /// writes a node's velocity and returns the change. Returns the speed of the fastest node that was touched.
  template <class Visit, class Settle>
  double push(const MpmDef& def, const Vec3& gravity, double h, const Visit& visit, const Settle& settle) {
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
      TouchedBody body{b.mass,
                       {momentum_of({1, 0, 0}), momentum_of({0, 1, 0}), momentum_of({0, 0, 1})},
                       b.velocity,
                       b.spin};
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
  /// Accepts the substep of `push`.
  void accept(double h) {
    bodies_.swap(trial_);
    for (ImmersedBody& b : bodies_) b.advance(h);
  }

 private:
  /// Distance from p, if it is inside, to the solid's surface. For a closed mesh the search radius for the
  /// nearest triangle doubles until one is found; an open sheet has no inside.
  static std::optional<PointDistance> inside(const Solid& solid, const Vec3& p, double cell) {
    if (solid.kind != SolidKind::mesh) return point_distance(solid, p, 0);
    const MeshSides sides = mesh_sides(solid);
    if (sides == MeshSides::front) return std::nullopt;
    const double most = 2 * bounding_radius(solid);
    for (double reach = cell;; reach *= 2) {
      const auto near = point_distance(solid, p, reach, sides);
      if (near || reach > most) return near;
    }
  }

  /// In squares of gravity.
  static constexpr double kSteady = 2;
  static constexpr double kMostRoom = 1e5;
  std::vector<ImmersedBody> bodies_, trial_;
  std::vector<TouchedNode> nodes_;
  std::vector<size_t> handles_;
};

}  // namespace truestep::mpm
