// Right-hand side of the system "particles": forces on single particles (body_forces.h), between neighbours
// (pair_forces.h), springs, user expressions, and pushes and drags from commands.
#pragma once
#include "engine/core/equations/force_field.h"
#include "engine/core/system.h"
#include "engine/kernels/springs/pair_force.h"
#include "engine/math/expression/names.h"
#include "engine/math/expression/rows.h"
#include "engine/systems/particles/body_forces.h"
#include "engine/systems/particles/coulomb.h"
#include "engine/systems/particles/particles_state.h"

namespace truestep::particles {

/// Gravity (m/s^2), electric (V/m) and magnetic (T) field, and the charge (C) that they act on.
struct UniformFields {
  Vec3 gravity, electric, magnetic;
  Charges charge;
};

class ParticlesField final : public ForceField {
 public:
  /// Error "scene_invalid" with an Issue when an expression does not parse.
  ParticlesField(const ParticlesDef& def, const Vec3& gravity, uint64_t seed);

  State initial_state() const override;
  void acceleration(const Phase& at, std::span<double> a, Evaluation& e) const override;
  Dependence dependence() const override { return dependence_; }
  std::optional<double> potential(const Phase& at, Evaluation& e) const override;
  double kinetic(const Phase& at, Evaluation& e) const override;
  std::optional<Stiffness> stiffness(const State& state) const override;

  /// The uniform part of the forces, and whether there is anything else; for methods that integrate the
  /// uniform part exactly and call `acceleration` for the rest.
  UniformFields uniform_fields(const State& state) const;
  bool varies(const State& state) const;
  void varying_acceleration(const Phase& at, std::span<double> a, Evaluation& e) const;

  /// Whether no particle acts on another and none is pushed or dragged; then a leapfrog step takes one pass.
  bool each_alone(const State& state) const;
  void leapfrog_alone(State& state, const StepInput& in) const;

  /// Acceleration of a single particle by the forces that act on it alone, at its birth.
  Vec3 single_acceleration(const State& state, double t, const Vec3& x, const Vec3& v, double mass) const;

  const ParticlesDef& def() const { return def_; }
  const ColliderSet& colliders() const { return colliders_; }
  size_t capacity() const { return capacity_; }

 private:
  BodyForces body_forces(const State& s) const;
  Charges charges(const State& s) const;
  void sum_forces(const BodyForces& body, const Phase& at, std::span<double> a, Evaluation& e) const;
  void add_springs(const Phase& at, std::span<double> a) const;
  void add_expression(const Phase& at, const double* mass, double* a, size_t begin, size_t end) const;
  void add_commands(const Phase& at, std::span<double> a) const;

  ParticlesDef def_;
  ColliderSet colliders_;
  Vec3 gravity_;
  uint64_t seed_;
  size_t capacity_;
  Dependence dependence_;
  std::vector<PairLaw> pair_laws_;
  ExpressionRows expression_;  ///< no outputs, or fx, fy, fz
};

}  // namespace truestep::particles
