// A liquid with a surface in a box (liquid_flow.h); its only part is its particles. A step is divided into as
// many equal substeps as its fastest particle requires. Commands: impulse on a particle.
#pragma once
#include "engine/core/system.h"
#include "engine/systems/grid_fluid/liquid/liquid_flow.h"

namespace truestep::grid_fluid {

class Liquid final : public StagedSystem {
 public:
  Liquid(const GridFluidDef& def, const BuildContext& context);

  State initial_state() const override { return start_; }
  void observe(const State& state, double t, Observables& out) const override;
  FieldView field(const State& state, size_t part, size_t field, std::vector<double>& scratch) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  void apply(State& state, const Command& command) const override;
  void warn(const State& state, double h, std::vector<Warning>& out) const override;

  const FlowModel& model() const { return model_; }
  double particle_mass() const { return mass_; }

  static constexpr int kMostSubsteps = 2000;

 private:
  void advance(State& state, const StepInput& in) const;
  LiquidFields fields(State& state) const;

  std::string id_;
  FlowModel model_;
  size_t rows_ = 0;
  double mass_ = 0;  ///< kg, of a particle
  State::Column velocity_ = 0, affine_ = 0, pressure_ = 0, fill_ = 0, numbers_ = 0;
  State start_;
};

/// Obstacles for drawings.
void draw_obstacles(const std::vector<ObstacleDef>& obstacles, Drawing& out);
}  // namespace truestep::grid_fluid
