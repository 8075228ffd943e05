// A step of one Newton iteration that ends with more energy than it had, although nothing supplies any, is
// taken again with all of Newton's iterations, and if that gains too in two parts, four and so on. One
// iteration takes springs as straight: one that turns by the angle a within the step is stretched by a^2 / 2,
// and where a rope or a net whips a stiff one makes energy of that. The energies are summed only where some
// spring may have turned by kTurns; the rest of a scene pays for a copy of its points. Whoever names the
// method in the scene gets the method alone.
#pragma once
#include <functional>

#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep::mass_spring {

class RisingStep {
 public:
  RisingStep(const MassSpringField& field, const IntegratorOptions& options);

  /// rad by which springs may turn before energies are looked at. Swept over five random scenes that need it:
  /// all hold from 0.003 to 0.03, one gains at 0.1, two at 0.3.
  static constexpr double kTurns = 0.03;
  /// Energy that a step may gain, as a fraction of its kinetic energy: the same scenes hold from 1e-5 to
  /// 3e-2, two of them gain at 0.1.
  static constexpr double kRise = 1e-3;
  static constexpr int kMostParts = 8;

  using Step = std::function<void(State&, const StepInput&)>;
  /// `usual`, and in its place `full` where the energy rises; the usual one where the full one has no
  /// solution.
  void step(State& s, const StepInput& in, const Step& usual, const Step& full) const;

 private:
  bool rises(const State& s, const StepInput& in, std::span<const double> x0,
             std::span<const double> v0) const;

  /// Allocates, in the first step of a workspace, what taking a step again needs.
  void reserve(State& s, const StepInput& in) const;

  const MassSpringField& field_;
  const IntegratorOptions& options_;
  double shortest_;  // m, of the springs' lengths
};

}  // namespace truestep::mass_spring
