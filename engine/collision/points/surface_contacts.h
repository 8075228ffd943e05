// Contacts of points whose springs or elements are solved implicitly: points that would end in a solid are
// held on its surface within the solve (integrators/implicit/newton/row_contacts.h), by an active set. A
// point is added where it would enter, sticks while its impulse is within Coulomb's cone, otherwise slides
// under mu N, and is released where the surface would have to pull it. The contacts of the last step are
// tried first, so that a system at rest needs one solve. Restitution follows the solve: a point that arrived
// at w leaves at e w. The search for the active set may end on another branch of stiff forces, far from the
// start of the step. A step that ends with more energy than it had, although nothing supplies any, is
// repeated without friction, and the remaining excess is removed from its velocities. Where these do not have
// as much, points that are in a solid have been moved out against stiff springs or elements: the step is
// repeated with such points kept at their depth, as far as nothing else moves them, so that the start of the
// step is among its possible ends, and if that gains too, everything waits for a step.
#pragma once
#include <vector>

#include "engine/collision/points/collider_set.h"
#include "engine/core/equations/force_field.h"
#include "engine/core/equations/integrator.h"
#include "engine/integrators/implicit/newton/row_contacts.h"

namespace truestep {

/// Columns of the state: positions, velocities and inverse masses per row, gravity (m/s^2) in one row.
struct SurfaceColumns {
  State::Column position, velocity, inverse_mass, gravity;
};

class SurfaceContacts {
 public:
  /// Whether anything besides moving solids supplies energy; if not, no step may end with more.
  enum class Supply : uint8_t { none, some };
  /// `fixed`: empty, or one bit per prescribed component of every row, which no surface moves.
  SurfaceContacts(const ColliderSet& colliders, const std::vector<Surface>& surfaces, double radius,
                  const SurfaceColumns& columns, std::span<const uint8_t> fixed = {})
      : colliders_(colliders), surfaces_(surfaces), radius_(radius), columns_(columns), fixed_(fixed) {}

  /// One step of the field with `method`, which must support RowContacts and whose columns the state must
  /// have. A step for which the method finds no solution is subdivided.
  void step(const ForceField& field, const Integrator& method, const IntegratorOptions& options, State& s,
            const StepInput& in, Supply supply) const;

 private:
  struct Start {
    std::span<const double> x, v;
  };
  enum class Friction : uint8_t { coulomb, none };
  /// Whether points in a solid are moved to its surface or only no deeper.
  enum class Depth : uint8_t { corrected, kept };
  struct Means {
    Friction friction;
    Depth depth;
  };
  void whole(const ForceField& field, const Integrator& method, const IntegratorOptions& options, State& s,
             const StepInput& in, Means by) const;
  double energy(const ForceField& field, const State& s, double t, const StepInput& in) const;
  /// J, energy at the start of a step and the most that is accepted at its end; infinite where energy is
  /// supplied.
  struct EnergyBound {
    double start, most;
  };
  EnergyBound energy_bound(const ForceField& field, const State& s, const StepInput& in, Supply supply) const;
  /// The whole step or, if that has no solution, its halves, and so on.
  void divided(const ForceField& field, const Integrator& method, const IntegratorOptions& options, State& s,
               const StepInput& in, Means by) const;
  /// J, the most that moving the points out of the solids they are in lifts them.
  double lift(const State& s, std::span<const double> x, double t) const;
  void take_up(const State& s, const RowContacts& on, const Start& start, const StepInput& in,
               Means by) const;
  bool revise(State& s, const RowContacts& on, const Start& start, const StepInput& in, int round,
              Means by) const;
  void finish(State& s, const RowContacts& on, const Start& start, const StepInput& in,
              std::span<const double> held_before) const;
  /// A surface's normal without the prescribed components; 0 if little of it is left.
  Vec3 free_normal(size_t i, const Vec3& normal) const;
  /// Holds the row on the surface at `place`, or no deeper in it than it is.
  void hold(const RowContacts& on, size_t i, const Vec3& x0, const NearSurface& surface, const Vec3& place,
            RowContacts::Kind kind, double h, Depth depth) const;

  const ColliderSet& colliders_;
  const std::vector<Surface>& surfaces_;
  double radius_;
  SurfaceColumns columns_;
  std::span<const uint8_t> fixed_;
};

}  // namespace truestep
