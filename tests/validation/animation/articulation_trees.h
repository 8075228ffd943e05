// Trees of links for tests: pendulums and tops.
#pragma once
#include "engine/systems/articulation/articulation.h"
#include "tests/validation/equations/stepping.h"

namespace truestep::test {

inline const Vec3 kDown{0, -9.81, 0};

inline articulation::ArticulationField field_of(const articulation::ArticulationDef& d,
                                                const Vec3& gravity = kDown) {
  return articulation::ArticulationField(articulation::build_model(d), gravity);
}

/// Point masses on rods of 1 m, the first turned by q from straight down.
inline articulation::ArticulationDef pendulum(size_t links, double q) {
  articulation::ArticulationDef d;
  for (size_t i = 0; i < links; ++i) {
    articulation::LinkDef l;
    l.mass = 1, l.center = {0, -1, 0}, l.q = {i == 0 ? q : 0};
    if (i > 0) l.offset = {0, -1, 0};
    d.links.push_back(l);
  }
  return d;
}

/// One body on a ball joint, its centre at `at`.
inline articulation::ArticulationDef top(double mass, const Vec3& at, const Vec3& moments,
                                         std::vector<double> w) {
  articulation::ArticulationDef d;
  articulation::LinkDef l;
  l.joint = articulation::JointType::spherical, l.mass = mass, l.center = at, l.v = std::move(w);
  l.inertia = {moments.x, moments.y, moments.z};
  d.links.push_back(l);
  return d;
}

}  // namespace truestep::test
