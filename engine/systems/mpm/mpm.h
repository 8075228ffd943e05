// The system type "mpm": snow, sand, water, jelly and foam by the material point method, particles that carry
// mass and deformation and a grid that is rebuilt every substep. Explicit, with substeps limited by the
// fastest particle or wave, or implicit (implicit.h). Commands: impulse, set_parameter (gravity).
#pragma once
#include <memory>

#include "engine/core/outputs/tabled.h"
#include "engine/systems/mpm/solver.h"

namespace truestep::mpm {

class Mpm final : public Tabled<Mpm, StagedSystem> {
 public:
  Mpm(const MpmDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  void check(StateCheck& check, double t) const override;
  void apply(State& state, const Command& command) const override;
  std::optional<double> limit(Limit which, const State& state, double h) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  /// A medium: bodies may be immersed in it (coupling immersion).
  Ports ports() const override;

  const Setting& setting() const { return *setting_; }

 private:
  struct Whole;
  Whole whole(const State& state, double t) const;

  Vec3 gravity_;
  std::unique_ptr<const Setting> setting_;
  std::unique_ptr<const Solver> solver_;
};

std::unique_ptr<const System> build_mpm(const void* def, const BuildContext& context);

}  // namespace truestep::mpm
