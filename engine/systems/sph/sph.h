// The system type "sph": a liquid of particles by smoothed particle hydrodynamics, in the plane and in space.
// Substeps as short as the fastest particle requires. Commands: impulse, set_parameter (gravity).
#pragma once
#include <memory>

#include "engine/core/outputs/tabled.h"
#include "engine/systems/sph/setting.h"

namespace truestep::sph {

class Sph final : public Tabled<Sph, StagedSystem> {
 public:
  Sph(const SphDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override;
  std::vector<PlanRow> plan() const override;
  /// Kinetic, and the potential above the box's lowest corner. Open where walls move, nozzles pour, vortices
  /// are driven, or gravity acts along a periodic axis.
  std::optional<Energy> energy(const State& state, double t, Workspace& workspace,
                               const ThreadArena& arena) const override;
  void check(StateCheck& check, double t) const override;
  void apply(State& state, const Command& command) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  void warn(const State& s, double h, std::vector<Warning>& out) const override;
  Ports ports() const override;

  std::optional<double> limit(Limit which, const State& state, double h) const override;

  const Setting& setting() const { return *setting_; }

 private:
  struct Whole;
  Whole whole(const State& state, double t) const;
  /// kg/m^3
  void density(const State& state, ShownRows rows, double* out) const;
  bool driven(const Vec3& gravity) const;
  Vec3 gravity_;
  double dt_;  ///< s
  std::unique_ptr<const Setting> setting_;
  std::unique_ptr<const Solver> solver_;
  std::optional<State> start_;  ///< where the liquid settles
};

std::unique_ptr<const System> build_sph(const void* def, const BuildContext& context);

}  // namespace truestep::sph
