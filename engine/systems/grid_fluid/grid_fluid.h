// An incompressible fluid in a box of two or three dimensions on a staggered grid (flow.h): central
// differences for smooth flows, advection along paths for all others; walls, inflow, outflow, periodic sides;
// a transported scalar and its buoyancy. A step is divided into as many equal substeps as speed and viscosity
// require, and its rest anew when the flow becomes too fast for them. Steady flows are found directly
// (steady/steady_flow.h). Commands: set_parameter viscosity; impulse gives momentum to the fluid around a
// point.
#pragma once
#include "engine/core/outputs/tabled.h"
#include "engine/core/system.h"
#include "engine/systems/grid_fluid/flow.h"

namespace truestep::grid_fluid {

struct FluidNumbers;

class GridFluid final : public Tabled<GridFluid, StagedSystem> {
 public:
  GridFluid(const GridFluidDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override { return start_; }
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  void apply(State& state, const Command& command) const override;
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
  /// kg, of the fluid between the obstacles.
  double mass(const State& state, double t) const;
  /// J, potential of two fluids about the origin.
  double gravity_of_two(const State& state) const;
  double rms_error(const State& state, double t) const;
  FluidNumbers measure(const State& state, double t) const;
  PartInfo cells() const;
  /// What fields show of every cell.
  void velocity(const State& state, ShownRows, double* out) const;
  void speed(const State& state, ShownRows, double* out) const;
  void pressure(const State& state, ShownRows, double* out) const;
  void vorticity(const State& state, ShownRows, double* out) const;
  void copy_cells(const State& state, State::Column column, double* out) const;
  Vec3 velocity_in(const State& state, size_t at, const size_t* place) const;
  /// Largest substep for a flow that crosses this many cells per second.
  double largest_substep(double crossing_rate, double viscosity, double h) const;
  /// Cells per substep up to which results are reliable.
  double most_crossed() const;
  /// Number of substeps into which h (s) is divided after the `taken` ones that the step already had.
  /// Instability if they are more than kMostSubsteps.
  int substeps_for(double crossing_rate, double viscosity, double h, int taken) const;

  /// Share of the second fluid that the flow itself moves, after the one that is shown.
  State::Column border_column() const { return *second_ + 1; }

  /// Entries of the column `numbers`.
  enum Number : size_t {
    kViscosity,
    kLastStep,
    kSubsteps,
    kCfl,
    kIterations,
    kResidual,
    kDrag,
    kLift,
    kNumbers,
    kDivergence = kNumbers,  ///< FlowModel::keeps_divergence: there is one more
    kTorque,                 ///< obstacles turn: another one
    kBorderStep = kNumbers   ///< two fluids, which neither keep divergence nor turn obstacles
  };

  std::string id_;
  FlowModel model_;
  double room_ = 0;  ///< m^3 (m^2 in the plane) between obstacles at the start
  State::Column numbers_ = 0;
  std::optional<State::Column> rate_, scalar_, second_;
  std::optional<State::Column> stream_;  ///< of a steady flow; followed by `steady`
  State start_;
};

/// Column `steady`: viscosity (m^2/s) for which the flow was found; 0 before.
enum SteadyNumber : size_t { kFoundFor, kSteadyIterations, kChange, kSteadyNumbers };

/// Cells per substep along paths up to which a first-order rule is accurate enough (Foster, Fedkiw 2001,
/// "Practical animation of liquids", section 4).
inline constexpr double kMostTraced = 5;
/// Warns when more than `most` cells are crossed in a substep of h (s).
void warn_of_crossing(double cells, double most, double h, std::vector<Warning>& out);

std::unique_ptr<const System> build_grid_fluid(const void* def, const BuildContext& context);

}  // namespace truestep::grid_fluid
