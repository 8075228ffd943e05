// A liquid with a surface in a box (liquid_flow.h); its only part is its particles. A step is divided into as
// many equal substeps as its fastest particle requires. Particles enter through nozzles and sides of kind
// inflow, and leave through open sides and in kill regions (liquid_come_and_go.cc). Commands: impulse on a
// particle.
#pragma once
#include "engine/core/outputs/tabled.h"
#include "engine/core/system.h"
#include "engine/systems/grid_fluid/liquid/liquid_flow.h"

namespace truestep::grid_fluid {

struct FluidNumbers;

class Liquid final : public Tabled<Liquid, StagedSystem> {
 public:
  Liquid(const GridFluidDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override { return start_; }
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  void apply(State& state, const Command& command) const override;
  void warn(const State& state, double h, std::vector<Warning>& out) const override;
  void check(StateCheck& check, double t) const override;

  const FlowModel& model() const { return model_; }
  double particle_mass() const { return mass_; }

  static constexpr int kMostSubsteps = 2000;

 private:
  void advance(State& state, const StepInput& in) const;
  LiquidFields fields(State& state) const;
  size_t rows(const State& state) const { return state.rows(kPosition); }
  void add_columns(const std::vector<StartingPlace>& places);
  FluidNumbers measure(const State& state, double t) const;
  /// In each particle's cell.
  void of_cells(const State& state, State::Column column, double scale, double* out) const;
  // Adds and removes particles within a substep of h that starts at t (s).
  void come_and_go(State& state, const StepInput& in, const GivenFlow& given, double t, double h) const;
  void remove_gone(State& state, const StepInput& in) const;
  void feed(State& state, Workspace& workspace, const GivenFlow& given, double t, double h) const;
  void pour(State& state, double t, Workspace& workspace) const;
  /// One more particle if there is room for it.
  void append(State& state, const Vec3& at, const Vec3& velocity, double dye) const;
  Vec3 side_velocity(const GivenFlow::Side& side, double t, const Vec3& at) const;
  template <class F>
  void for_particle_columns(F&& f) const;

  static constexpr State::Column kPosition = 0;
  /// Entries of the column `counts`.
  enum Count : size_t { kEmitted, kKilled, kLeft, kRefused, kBorn, kCounts };

  std::string id_;
  FlowModel model_;
  std::vector<LiquidInlet> inlets_;
  size_t capacity_ = 0;  ///< particles at most
  double mass_ = 0;      ///< kg, of a particle
  State::Column velocity_ = 0, affine_ = 0, pressure_ = 0, fill_ = 0, numbers_ = 0;
  /// 0: absent. `owed_`: what undoing compression has lifted a particle's body by and has not been taken from
  /// its motion yet, m^2/s^2 per particle; `layers_`: each nozzle's next layer; `phase_`: spacings by which
  /// the liquid has come in since the last particle, for every row of particles through an inflow.
  State::Column owed_ = 0, dye_ = 0, id_column_ = 0, layers_ = 0, counts_ = 0, phase_ = 0;
  State start_;
};

template <class F>
void Liquid::for_particle_columns(F&& f) const {
  f(kPosition), f(velocity_);
  for (const State::Column c : {affine_, owed_, dye_, id_column_}) {
    if (c) f(c);
  }
}

/// Entries of the column `numbers`, of the last substep but for what has been lifted since the start.
enum LiquidNumber : size_t {
  kLiquidSubsteps,
  kLiquidCfl,
  kLiquidIterations,
  kLiquidResidual,
  kDensityIterations,
  kMeanCompression,
  kMaxCompression,
  kLifted,  ///< m^2/s^2, energy over a particle's mass that undoing compression has given
  kLiquidNumbers
};

/// Obstacles for drawings.
void draw_obstacles(const std::vector<ObstacleDef>& obstacles, Drawing& out);
}  // namespace truestep::grid_fluid
