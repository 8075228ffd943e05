// The system type "particles": a ParticlesField advanced by any explicit integrator, then contacts with
// colliders, removals and births. Commands: push, impulse, drag, release, spawn, remove, set_parameter.
#pragma once
#include "engine/core/equations/force_system.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/table/default_method.h"
#include "engine/systems/particles/particles_field.h"

namespace truestep::particles {

class Particles final : public Tabled<Particles, ForceSystem> {
 public:
  /// Error "scene_invalid" when the integrator is unsuitable or an expression does not parse.
  static std::unique_ptr<const Particles> make(const ParticlesDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void check(StateCheck& check, double t) const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  /// The solids: a ball around every particle.
  Ports ports() const override;
  /// Open when particles are created, removed, driven, dragged or pushed out by obstacles.
  Energy::Exchange exchange(const State& state) const override;

 private:
  Particles(std::unique_ptr<const ParticlesField> field, const ChosenMethod& method, const ParticlesDef& def,
            uint64_t seed);
  void plan_stages(const std::string& why_this_method);
  void remember(State& state, const StepInput& in) const;
  void collide(State& state, const StepInput& in) const;
  void end_lives(State& state, const StepInput& in) const;
  void emit(State& state, const StepInput& in) const;
  void add_newborn(State& state, const StepInput& in, const EmitterDef& e, size_t emitter, uint64_t n,
                   double born) const;
  void set_parameter(State& state, const Command& command) const;
  static void ages(const State& state, ShownRows rows, double* out);
  struct Whole;
  Whole whole(const State& state, double t) const;

  const ParticlesField& particles_;
  uint64_t seed_;
};

std::unique_ptr<const System> build_particles(const void* def, const BuildContext& context);
Cost particles_cost(const void* def);

}  // namespace truestep::particles
