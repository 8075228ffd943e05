// What boundaries hold in an implicit substep: nodes that may not move along given axes. Boundaries that
// separate hold only where they are under pressure, which an active set finds between solves (implicit.h).
// Friction acts on the velocities before the stresses of the substep are known.
#pragma once
#include <algorithm>
#include <vector>

#include "engine/systems/mpm/substep.h"

namespace truestep::mpm {

template <int D, int Nodes>
class HeldNodes {
  using G = Grid<D, Nodes, double>;
  using Vector = Aligned<double>;

 public:
  /// Room for boundaries at this many nodes.
  void reserve(size_t nodes) {
    contacts_.reserve(nodes);
    held_.reserve(contacts_.capacity());
  }

  /// Finds the boundaries at nodes at time t. v (m/s) becomes the velocities that they allow, starting from
  /// `anchor`, whose velocities friction changes.
  void find(const G& g, const Setting& set, double t, Vector& anchor, Vector& v) {
    contacts_.clear();
    v = anchor;
    for (size_t k = 0; k < g.blocks.blocks.size(); ++k) {
      const Block& b = g.blocks.blocks[k];
      if (g.is_free(set, b, t)) continue;
      for (size_t n = 0; n < G::Size::kBlockNodes; ++n) {
        const size_t node = k * G::kBlockNumbers + 4 * n;
        if (!(g.nodes[node] > 0)) continue;
        Vec3 u = at(anchor, node);
        g.for_boundaries(
            set, g.place_of(set.def, b, n), t,
            [&](const Vec3& normal, const Vec3& of, mpm::Contact kind, double friction) {
              const bool lets_go = kind == mpm::Contact::separate;
              const bool active = !lets_go || dot(u - of, normal) < 0;
              const Vec3 gain = bounded(u, normal, of, kind, friction) - u;
              u += gain;
              // Friction changes v*; the impulse along the normal is left to the solve.
              put(anchor, node, at(anchor, node) + gain - normal * dot(gain, normal));
              const bool stuck = active && friction > 0 && norm2(u - of) == 0;
              contacts_.push_back(
                  {node, normal, of, kind == mpm::Contact::sticky || (lets_go && stuck), lets_go, active});
            });
        put(v, node, u);
      }
    }
    hold();
  }

  /// Removes what held nodes may not do.
  void project(Vector& v) const {
    for (const Held& held : held_) {
      Vec3 u = at(v, held.node);
      for (int k = 0; k < held.count; ++k) u -= held.axes[k] * dot(u, held.axes[k]);
      put(v, held.node, held.count == D ? Vec3{} : u);
    }
  }

  /// v = rest, but where active boundaries move.
  void rest(Vector& v) const {
    std::fill(v.begin(), v.end(), 0.0);
    for (const Contact& c : contacts_) {
      if (c.active) put(v, c.node, c.all ? c.velocity : c.normal * dot(c.velocity, c.normal));
    }
  }

  /// Releases boundaries under tension and activates those that nodes would pass, given the gradient of the
  /// energy (N s), at most `push`, at velocities v, at most `speed`. Returns whether any changed.
  bool change(Vector& v, const Vector& gradient, double push, double speed) {
    bool any = false;
    for (Contact& c : contacts_) {
      if (!c.lets_go) continue;
      const Vec3 u = at(v, c.node);
      // The gradient is the boundary's impulse: along the normal under pressure.
      const bool pulled = c.active && dot(at(gradient, c.node), c.normal) < -kStill * push;
      const double into = dot(u - c.velocity, c.normal), reach = kPass * speed;
      if (pulled) {
        c.active = false, any = true;
      } else if (!c.active && into < -reach) {
        put(v, c.node, u - c.normal * into);
        c.active = true, any = true;
      }
    }
    if (any) hold();
    return any;
  }

 private:
  static constexpr double kStill = 1e-9, kPass = 1e-9;

  /// A boundary at a node; while active it prescribes the node's velocity along the normal, or all of it.
  struct Contact {
    size_t node;  ///< first of its numbers
    Vec3 normal, velocity;
    bool all, lets_go, active;
  };
  /// Orthonormal directions in which a node may not move.
  struct Held {
    size_t node;
    int count;
    Vec3 axes[3];
  };

  static Vec3 at(const Vector& v, size_t node) { return {v[node + 1], v[node + 2], v[node + 3]}; }
  static void put(Vector& v, size_t node, const Vec3& to) {
    v[node + 1] = to.x, v[node + 2] = to.y, v[node + 3] = to.z;
  }

  /// Collects the axes held by active boundaries.
  void hold() {
    held_.clear();
    for (const Contact& c : contacts_) {
      if (!c.active) continue;
      if (held_.empty() || held_.back().node != c.node) held_.push_back({c.node, 0, {}});
      Held& held = held_.back();
      const auto add = [&](Vec3 axis) {
        for (int k = 0; k < held.count; ++k) axis -= held.axes[k] * dot(axis, held.axes[k]);
        const double left = norm(axis);
        if (held.count < D && left > 1e-6) held.axes[held.count++] = axis / left;
      };
      add(c.normal);
      if (c.all) add({1, 0, 0}), add({0, 1, 0});
      if (c.all && D == 3) add({0, 0, 1});
    }
  }

  std::vector<Contact> contacts_;
  std::vector<Held> held_;
};

}  // namespace truestep::mpm
