// A step that ends with more energy than it began with, although nothing supplies any, is repeated, with a
// method that gains less or in two parts, four and so on: methods that damp oscillations can feed rotations.
// Energies are summed only when the system says that a step was fast enough to gain any; all other steps pay
// for a copy of what they change.
#pragma once
#include <functional>

#include "engine/core/equations/force_field.h"
#include "engine/core/system.h"

namespace truestep {

class RisingStep {
 public:
  struct Bounds {
    double rise;     ///< energy that a step may gain, as a fraction of its kinetic energy
    int most_parts;  ///< a power of 2
  };
  /// `field` must outlive this, and have a potential.
  RisingStep(const ForceField& field, const Bounds& bounds) : field_(field), bounds_(bounds) {}

  using Step = std::function<void(State&, const StepInput&)>;
  /// Whether velocities before and after a step of h (s) are large enough for it to gain energy.
  using Fast = std::function<bool(std::span<const double> v0, std::span<const double> v, double h)>;

  /// Takes `usual`, and in its place `full`, whole or in parts, while the energy rises; the usual one where
  /// the full one has no solution. `reserve` allocates what the full one needs, in a workspace's first step.
  void step(State& s, const StepInput& in, const Fast& fast, const Step& usual, const Step& full,
            const Step& reserve) const;
  /// Takes `one`, in parts while it has no solution or, if nothing supplies energy, while that rises.
  /// Instability of the whole step when no parts have a solution.
  enum class Supply : uint8_t { none, some };
  void step_in_parts(State& s, const StepInput& in, Supply supply, const Fast& fast, const Step& one) const;

 private:
  struct Before;
  /// Keeps what the step changes; in a workspace's first step allocates what later ones need.
  Before& start(State& s, const StepInput& in, const Step& reserve) const;
  bool rises(const State& s, const StepInput& in, std::span<const double> x0, std::span<const double> v0,
             const Fast& fast) const;

  const ForceField& field_;
  Bounds bounds_;
};

}  // namespace truestep
