// Contacts of springs and elements that a method solves implicitly: points that would end in a solid are held
// to its surface within the solution (integrators/row_contacts.h), by an active set. A point is taken up
// where it would enter, sticks while Coulomb's cone holds it, slides under mu N where not, and is let go
// where it is pulled. What was held is tried first in the next step, so that what is at rest needs one
// solution. Bounces follow the solution: a point that came at w leaves at e w. The search for that set may
// end at another branch of stiff forces, far from where the step began. A step that ends with more energy
// than it had, where nothing brings any, is made again without friction, and what is still too much is taken
// from its velocities.
#pragma once
#include <vector>

#include "engine/collision/points/collider_set.h"
#include "engine/core/force_field.h"
#include "engine/core/integrator.h"
#include "engine/integrators/implicit/row_contacts.h"

namespace truestep {

/// Of the state: positions, velocities and inverse masses per row, gravity (m/s^2) in one row.
struct SurfaceColumns {
  State::Column position, velocity, inverse_mass, gravity;
};

class SurfaceContacts {
 public:
  /// What brings energy besides the solids' own motion: nothing, so that no step may end with more, or
  /// something.
  enum class Supply : uint8_t { none, some };
  /// `fixed`: empty, or per row a bit for every component that is prescribed, which no surface moves.
  SurfaceContacts(const ColliderSet& colliders, const std::vector<Surface>& surfaces, double radius,
                  const SurfaceColumns& columns, std::span<const uint8_t> fixed = {})
      : colliders_(colliders), surfaces_(surfaces), radius_(radius), columns_(columns), fixed_(fixed) {}

  /// One step of the field with `method`, which must know RowContacts; the state has its columns. Where the
  /// method finds no solution the step is divided.
  void step(const ForceField& field, const Integrator& method, const IntegratorOptions& options, State& s,
            const StepInput& in, Supply supply) const;

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
  EnergyBound energy_bound(const ForceField& field, const State& s, const StepInput& in, Supply supply) const;
  /// The step, or its halves where it has no solution as a whole, and so on.
  void divided(const ForceField& field, const Integrator& method, const IntegratorOptions& options, State& s,
               const StepInput& in, Friction friction) const;
  void take_up(const State& s, const RowContacts& on, const Start& start, const StepInput& in) const;
  bool revise(State& s, const RowContacts& on, const Start& start, const StepInput& in, int round,
              Friction friction) const;
  void finish(State& s, const RowContacts& on, const Start& start, const StepInput& in,
              std::span<const double> held_before) const;
  /// A surface's normal without components that are prescribed; 0 where little is left of it.
  Vec3 free_normal(size_t i, const Vec3& normal) const;
  /// The row stays on the surface at `place`.
  void hold(const RowContacts& on, size_t i, const Vec3& x0, const NearSurface& surface, const Vec3& place,
            RowContacts::Kind kind, double h) const;

  const ColliderSet& colliders_;
  const std::vector<Surface>& surfaces_;
  double radius_;
  SurfaceColumns columns_;
  std::span<const uint8_t> fixed_;
};

}  // namespace truestep
