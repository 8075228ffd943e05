// Contacts of springs that a method solves implicitly: points that would end in a solid are held to its
// surface within the solution (integrators/row_contacts.h), by an active set. A point is taken up where it
// would enter, sticks while Coulomb's cone holds it, slides under mu N where not, and is let go where it is
// pulled. What was held is tried first in the next step, so that cloth at rest needs one solution. Bounces
// follow the solution: a point that came at w leaves at e w.
// The search for that set may end at another branch of stiff springs, far from where the step began. A step
// that ends with more energy than it had, where nothing brings any, is made again without friction, and what
// is still too much is taken from its velocities.
#pragma once
#include <vector>

#include "engine/collision/points/collider_set.h"
#include "engine/core/force_system.h"
#include "engine/integrators/implicit/row_contacts.h"

namespace truestep::mass_spring {

class SurfaceContacts {
 public:
  SurfaceContacts(const ColliderSet& colliders, const std::vector<Surface>& surfaces, double radius)
      : colliders_(colliders), surfaces_(surfaces), radius_(radius) {}

  /// One step of the field with `method`, which must know RowContacts; the state has its columns. Where the
  /// method finds no solution the step is divided.
  void step(const ForceField& field, const Integrator& method, const IntegratorOptions& options, State& s,
            const StepInput& in) const;

 private:
  struct Start {
    std::span<const double> x, v;
  };
  enum class Friction : uint8_t { coulomb, none };
  void whole(const ForceField& field, const Integrator& method, const IntegratorOptions& options, State& s,
             const StepInput& in, Friction friction) const;
  double energy(const ForceField& field, const State& s, double t, const StepInput& in) const;
  /// J at the start of a step, and at most at the end of a sound one; infinite where anything brings energy.
  struct EnergyBound {
    double start, most;
  };
  EnergyBound energy_bound(const ForceField& field, const State& s, const StepInput& in) const;
  /// The step, or its halves where it has no solution as a whole, and so on.
  void divided(const ForceField& field, const Integrator& method, const IntegratorOptions& options, State& s,
               const StepInput& in, Friction friction) const;
  void take_up(const State& s, const RowContacts& on, const Start& start, const StepInput& in) const;
  bool revise(State& s, const RowContacts& on, const Start& start, const StepInput& in, int round,
              Friction friction) const;
  void finish(State& s, const RowContacts& on, const Start& start, const StepInput& in,
              std::span<const double> held_before) const;
  /// The row stays on the surface at `place`.
  void hold(const RowContacts& on, size_t i, const Vec3& x0, const NearSurface& at, const Vec3& place,
            RowContacts::Kind kind, double h) const;

  const ColliderSet& colliders_;
  const std::vector<Surface>& surfaces_;
  double radius_;
};

}  // namespace truestep::mass_spring
