// Random trees of links with all kinds of joints.
#pragma once
#include "engine/systems/articulation/tree.h"

namespace truestep::articulation {

/// Numbers in [-1, 1] from a counter.
struct Draw {
  uint64_t state;
  double operator()() {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return double(int64_t(state >> 11)) / double(1ull << 52) - 1;
  }
  Vec3 vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }
  Quat quaternion() {
    const Vec3 v = vector();
    return normalized(Quat{0.3 + (*this)(), v.x, v.y, v.z});
  }
};

/// A body of a few random points of mass.
inline spatial::Inertia body(Draw& draw) {
  spatial::Inertia b;
  for (int k = 0; k < 5; ++k) {
    const Vec3 r = draw.vector();
    const double m = 1.2 + draw();
    b.m += m, b.h += r * m;
    b.I += {m * (r.y * r.y + r.z * r.z),
            m * (r.x * r.x + r.z * r.z),
            m * (r.x * r.x + r.y * r.y),
            -m * r.x * r.y,
            -m * r.x * r.z,
            -m * r.y * r.z};
  }
  return b;
}

inline Tree random_tree(Draw& draw, int nodes) {
  Tree t;
  for (int i = 0; i < nodes; ++i) {
    Node n;
    n.move = static_cast<Move>(static_cast<int>(2.5 * (1 + draw())) % 5);
    n.parent = static_cast<int32_t>((0.5 + 0.5 * draw()) * (i + 1)) - 1;
    n.frame = {rotation(draw.quaternion()), draw.vector()};
    n.axis = normalized(draw.vector());
    n.inertia = body(draw);
    t.add(n);
  }
  return t;
}

}  // namespace truestep::articulation
