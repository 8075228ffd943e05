// The system type "nbody": bodies that attract each other (nbody_field.h), advanced by any explicit method
// from collision to collision (impacts.h). Commands: push, impulse, drag, release, set_parameter
// (gravitational_constant, softening).
#pragma once
#include "engine/core/equations/force_system.h"
#include "engine/core/outputs/tabled.h"
#include "engine/integrators/table/default_method.h"
#include "engine/systems/nbody/nbody_field.h"

namespace truestep::nbody {

class Nbody final : public Tabled<Nbody, ForceSystem> {
 public:
  static const OutputTable& outputs();
  /// Error "scene_invalid" when the integrator is unknown or unsuitable.
  static std::unique_ptr<const Nbody> make(const NbodyDef& def, const BuildContext& context);

  /// Of touches that a step had no room for, and of bodies that touch faster than fixed steps resolve.
  void warn(const State& state, double h, std::vector<Warning>& out) const override;
  void check(StateCheck& check, double t) const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  /// Open when bodies collide and while drags hold them.
  Energy::Exchange exchange(const State& state) const override;

 private:
  struct Whole;
  Whole whole(const State& state, double t) const;
  struct Touches;
  static Touches touches(const State& state);
  Nbody(std::unique_ptr<const NbodyField> field, const ChosenMethod& method, const NbodyDef& def);
  void plan_stages(const std::string& why_this_method);

  const NbodyField& bodies_;
  double draw_radius_;
};

std::unique_ptr<const System> build_nbody(const void* def, const BuildContext& context);

}  // namespace truestep::nbody
