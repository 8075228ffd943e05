// A step of one Newton iteration that ends with more energy than it began with, although nothing supplies
// any, is repeated with as many iterations as Newton's method needs, and if that gains energy too, in two
// parts, in four, and so on. A single iteration lets springs turn along a tangent: one that turns by the
// angle a is stretched by a^2 / 2 of its length, which is much energy where a stiff one whips about in a rope
// or a net. Energies are summed only when some spring may have turned by kTurns; all other steps pay for a
// copy of their points. A method that the scene names is used as it is.
#pragma once
#include <functional>

#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep::mass_spring {

class RisingStep {
 public:
  RisingStep(const MassSpringField& field, const IntegratorOptions& options);

  /// rad by which springs may turn before energies are compared. Of five random scenes that need it all hold
  /// with 0.003 to 0.03, one gains energy with 0.1, two with 0.3.
  static constexpr double kTurns = 0.03;
  /// Energy that a step may gain, as a fraction of its kinetic energy: the same scenes hold with 1e-5 to
  /// 3e-2, two of them gain energy with 0.1.
  static constexpr double kRise = 1e-3;
  static constexpr int kMostParts = 8;

  using Step = std::function<void(State&, const StepInput&)>;
  /// Takes the step `usual`; if the energy rises, `full` in its place, unless that has no solution.
  void step(State& s, const StepInput& in, const Step& usual, const Step& full) const;

 private:
  bool rises(const State& s, const StepInput& in, std::span<const double> x0,
             std::span<const double> v0) const;

  /// Allocates in a workspace's first step what repeating a step needs.
  void reserve(State& s, const StepInput& in) const;

  const MassSpringField& field_;
  const IntegratorOptions& options_;
  double shortest_;  // m, of the springs' lengths
};

}  // namespace truestep::mass_spring
