// An incompressible fluid in a box of two or three dimensions on a staggered grid (flow.h): smooth flows by
// central differences, any other along paths; walls, inflow, outflow, periodic sides; what the flow carries
// and what that weighs. A step is divided into as many equal substeps as its speed and viscosity ask for.
// Steady flows are found at once (steady_flow.h). Commands: set_parameter viscosity; impulse gives momentum
// to the fluid around a place.
#pragma once
#include "engine/core/system.h"
#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

class GridFluid final : public StagedSystem {
 public:
  GridFluid(const GridFluidDef& def, const BuildContext& context);

  State initial_state() const override { return start_; }
  void observe(const State& state, double t, Observables& out) const override;
  FieldView field(const State& state, size_t part, size_t field, std::vector<double>& scratch) const override;
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  void apply(State& state, const Command& command) const override;
  std::vector<std::string> remedies() const override;
  void warn(const State& state, double h, std::vector<Warning>& out) const override;
  void check(StateCheck& check, double) const override { check.finish(); }

  const FlowModel& model() const { return model_; }
  /// Columns: the velocity's components first.
  State::Column pressure_column() const { return model_.grid.dimensions; }

  static constexpr int kMostSubsteps = 2000;

 private:
  void advance(State& state, const StepInput& in) const;
  void find_steady(State& state, const StepInput& in) const;
  FlowFields fields(State& state) const;
  double rms_error(const State& state, double t) const;
  void vorticity(const State& state, double* out) const;
  /// Largest substep for a flow that crosses so many cells a second.
  double largest_substep(double crossing_rate, double viscosity, double h) const;

  /// Share of the second fluid that the flow itself moves, after the one that is shown.
  State::Column border_column() const { return *second_ + 1; }

  std::string id_;
  FlowModel model_;
  State::Column numbers_ = 0;
  std::optional<State::Column> rate_, scalar_, second_;
  std::optional<State::Column> stream_;  ///< of a steady flow; the next one is `steady`
  State start_;
};

/// Column `steady`: viscosity (m^2/s) that the flow was found for, 0 before.
enum SteadyNumber : size_t { kFoundFor, kSteadyIterations, kChange, kSteadyNumbers };

/// Cells along paths that a first-order rule follows closely enough (Foster, Fedkiw 2001, "Practical
/// animation of liquids", section 4).
inline constexpr double kMostTraced = 5;
/// Warns when more than `most` cells are crossed in a substep of h (s).
void warn_of_crossing(double cells, double most, double h, std::vector<Warning>& out);

std::unique_ptr<const System> build_grid_fluid(const void* def, const BuildContext& context);

}  // namespace truestep::grid_fluid
