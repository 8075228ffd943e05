// People in the order of a grid's cells, and the forces on one of them.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/systems/crowd/crowd.h"

namespace truestep::crowd {

struct Crowd::Sorted {
  PointGrid grid;
  std::vector<double> v, r;
  std::vector<uint32_t> person;

  void build(const State& s, double reach, const ThreadArena& arena) {
    grid.build(s.f64(Columns::position), reach, arena);
    const size_t n = grid.size();
    v.resize(3 * n), r.resize(n), person.resize(n);
    const double* velocity = s.f64(Columns::velocity).data();
    for (size_t k = 0; k < n; ++k) {
      const uint32_t i = grid.point(k);
      store3(v.data(), k, load3(velocity, i));
      r[k] = s.f64(Columns::radius)[i], person[k] = s.span<uint32_t>(Columns::person)[i];
    }
  }
};

struct Crowd::Load {
  size_t row = 0;
  Vec3 force;          ///< N
  double radial = 0;   ///< N, sum of sizes
  double sliding = 0;  ///< kg/s, sum of friction's coefficients
  double mass = 0, speed = 0, stiffness = 0;
  double gap = HUGE_VAL;  ///< m, to the nearest neighbour's rim

  void add(const SocialLaw& law, const SocialForce& f, double weight, double distance, double reach) {
    force += f.social * weight + f.contact;
    radial += f.radial, sliding += f.sliding;
    stiffness += norm(f.social) / law.range + (reach > distance ? law.stiffness : 0);
  }
};

/// Longest stable substep (s) of symplectic Euler under these contact forces, at a quarter of its limits 2 /
/// omega and 2 / gamma: two neighbours moving against each other feel twice their own stiffness. Nobody moves
/// farther than half the decay length of the repulsion.
inline double stable_substep(double stiffness, double sliding, double mass, double speed, double range) {
  double h = 1;
  if (stiffness > 0) h = std::min(h, 0.5 * std::sqrt(0.5 * mass / stiffness));
  if (sliding > 0) h = std::min(h, 0.25 * mass / sliding);
  if (stiffness > 0 && speed > 0) h = std::min(h, 0.5 * range / speed);
  return h;
}

}  // namespace truestep::crowd
