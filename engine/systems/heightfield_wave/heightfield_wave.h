// Shallow water over a bed in a basin of one or two dimensions (kernels/shallow/water.h): waves much longer
// than the depth, bores, floods over dry ground. Integrated by Heun's method in strong-stability-preserving
// form (Shu, Osher 1988), in as many substeps as the waves require. Gravity's magnitude acts along -z. Mass
// is conserved to rounding; a lake at rest stays at rest, also around islands. Commands: set_parameter
// friction; impulse gives momentum to the water of a cell.
#pragma once
#include "engine/core/outputs/tabled.h"
#include "engine/core/system.h"
#include "engine/systems/heightfield_wave/basin_texts.h"

namespace truestep::heightfield_wave {

class HeightfieldWave final : public Tabled<HeightfieldWave, StagedSystem> {
 public:
  HeightfieldWave(const HeightfieldWaveDef& def, const BuildContext& context);

  static const OutputTable& outputs();
  State initial_state() const override { return start_; }
  void draw(const State& state, double t, Wish wishes, Drawing& out) const override;
  void apply(State& state, const Command& command) const override;
  std::optional<double> limit(Limit which, const State& state, double h) const override;
  void check(StateCheck& check, double) const override { check.finish(); }

  const shallow::Basin& basin() const { return basin_; }
  static constexpr int kMostSubsteps = 2000;

 private:
  /// Scratch memory of a step; it points into no state.
  struct Work {
    shallow::Primitives p;
    std::vector<double> rates, before, row_speeds;
  };
  void bind(Work& work) const;
  void advance(State& state, const StepInput& in) const;
  /// water += h rates, no depth below 0.
  void add(const shallow::Water& water, const Work& work, double h, const ThreadArena& arena) const;
  /// The mean of water and its state before the substep, slowed by friction at the bed.
  void finish(const shallow::Water& water, const Work& work, double friction, double h,
              const ThreadArena& arena) const;
  shallow::Water water(State& state) const;
  shallow::Water rows(std::vector<double>& of) const;
  double bed(size_t cell) const;
  struct Whole;
  Whole whole(const State& state, double t) const;
  PartInfo cells() const;
  /// m/s, mean over the depth.
  Vec3 velocity(const State& state, size_t cell) const;

  std::string id_;
  HeightfieldWaveDef def_;
  shallow::Basin basin_;
  BasinTexts texts_;
  std::vector<double> bed_;  ///< with ghosts
  State::Column numbers_ = 0;
  State start_;
};

std::unique_ptr<const System> build_heightfield_wave(const void* def, const BuildContext& context);

}  // namespace truestep::heightfield_wave
