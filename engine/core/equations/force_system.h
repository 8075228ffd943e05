// A force field and an integrator make a system. Derived systems add stages before and after the integration
// (emission, collisions ...) and commands of their own.
#pragma once
#include <memory>

#include "engine/core/equations/force_field.h"
#include "engine/core/equations/integrator.h"
#include "engine/core/system.h"

namespace truestep {

class ForceSystem : public StagedSystem {
 public:
  ~ForceSystem() override;
  State initial_state() const override;
  /// energy.kinetic, energy.potential and energy.total (J) if the field has them, and the method's counters.
  void observe(const State& state, double t, Observables& out) const override;
  /// position and velocity straight from the state: the first two fields of the main part.
  FieldView field(const State& state, size_t part, size_t field, std::vector<double>& scratch) const override;
  /// The stable dt from the field's stiffness and the method's stability interval.
  std::optional<double> limit(Limit which, const State& state, double h) const override;
  /// The field's energy, if it has a potential.
  std::optional<Energy> energy(const State& state, double t, Workspace& workspace,
                               const ThreadArena& arena) const override;

  const ForceField& force_field() const { return *field_; }
  const Integrator& integrator() const { return method_; }
  const IntegratorOptions& options() const { return options_; }

 protected:
  /// Whether the only forces in this state are those of the potential and friction.
  virtual Energy::Exchange exchange(const State& state) const { return Energy::Exchange::open; }
  /// Adds no stage: derived constructors call add_integration_stage in the right place.
  ForceSystem(std::unique_ptr<const ForceField> field, const Integrator& method, IntegratorOptions options);
  /// `why`: the reason for this method, for the plan.
  void add_integration_stage(const std::string& why = "");
  /// For systems that only exchange their initial energy: a limit of a thousand times the speeds that the
  /// initial state, its accelerations and its fastest oscillation could produce.
  void bound_speed();

 private:
  std::unique_ptr<const ForceField> field_;
  const Integrator& method_;
  IntegratorOptions options_;
  ColumnInfo position_, velocity_;
  std::optional<double> speed_limit_;
};

}  // namespace truestep
