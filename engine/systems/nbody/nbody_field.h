// Newton's attraction of bodies, and pushes and drags:
//   x_i'' = G sum_j m_j (x_j - x_i) w(|x_j - x_i|) + pushes and drags,
//   V = -G sum_{i<j} m_i m_j p(|x_i - x_j|)
// with w, p of kernels/gravity/softening.h.
#pragma once
#include "engine/core/equations/force_field.h"
#include "engine/systems/nbody/attraction.h"

namespace truestep::nbody {

class NbodyField final : public ForceField {
 public:
  NbodyField(const NbodyDef& def, uint64_t seed);

  State initial_state() const override { return start_; }
  void acceleration(const Phase& at, std::span<double> a, Evaluation& e) const override;
  Dependence dependence() const override;
  std::optional<double> potential(const Phase& at, Evaluation& e) const override;
  double kinetic(const Phase& at, Evaluation& e) const override;
  /// For many bodies: free fall across a softening length, or across half the mass, under the strongest pull.
  /// Unknown for few.
  std::optional<Stiffness> stiffness(const State& state) const override;

  /// Properties of a body's orbit about the first one at t = 0; 0 for the first.
  struct Orbit {
    double hill_radius = 0,
           circular_speed = 0;  ///< m, m/s; for the semi-major axis, or for the distance if unbound
  };
  /// By row at t = 0.
  const std::vector<Orbit>& orbits() const { return orbits_; }

  const NbodyDef& def() const { return def_; }
  const Attraction& attraction() const { return attraction_; }

 private:
  NbodyDef def_;
  Attraction attraction_;
  State start_;
  std::vector<Orbit> orbits_;
};

}  // namespace truestep::nbody
