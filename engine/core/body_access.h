// Bodies that couplings reach but whose rows are not free rigid bodies in space: links of a tree move in the
// coordinates of their joints, bodies of the plane stay in it. An impulse (J, T) on a row changes velocities
// by
//   (dv, dw) = W (J, T)       W: symmetric, never negative, of all rows at once
// and a correction of place (kg m, kg m^2 rad) moves rows as far. Const like the system that owns it.
#pragma once
#include <span>
#include <vector>

#include "engine/core/state.h"
#include "engine/core/workspace.h"
#include "engine/math/quaternion.h"

namespace truestep {

struct BodyMotion {
  Vec3 place;  ///< m, of the centre of mass
  Quat orientation;
  Vec3 velocity, spin;  ///< m/s and rad/s, world
};
/// N s and N m s about the centre of mass; of corrections kg m and kg m^2 rad.
struct BodyImpulse {
  Vec3 impulse, twist;
  bool none() const { return norm2(impulse) + norm2(twist) == 0; }
};
/// m/s of the centre of mass and rad/s.
struct BodyTwist {
  Vec3 velocity, spin;
};

class BodyAccess;

/// The system behind bodies, where their columns do not say all.
class BodyOwner {
 public:
  virtual ~BodyOwner() = default;
  /// Wakes the body in that row and all that it rests on, carries or is joined to. Cheap when it is awake.
  virtual void wake(State& state, size_t row) const = 0;
  /// Where rows are not free bodies in space; null: they are.
  virtual const BodyAccess* access() const { return nullptr; }
};

class BodyAccess : public BodyOwner {
 public:
  const BodyAccess* access() const final { return this; }
  /// Bodies of the plane are prisms along z: their corners are edges, and one place of each is enough.
  enum class Space : uint8_t { space, plane };
  virtual Space space() const { return Space::space; }
  /// Somebody begins to look: what was kept in `memory` of other states, or of this one before a step, goes.
  virtual void forget(Workspace& memory) const {}
  /// Rows, always the same.
  virtual size_t count() const = 0;
  /// Index into the port's forms.
  virtual uint32_t form(const State& state, size_t row) const = 0;
  virtual BodyMotion motion(const State& state, size_t row) const = 0;
  /// Of all rows.
  virtual void motions(const State& state, std::span<BodyMotion> out, Workspace& memory) const = 0;
  /// What an impulse on a row changes of that row.
  virtual BodyTwist answer(const State& state, size_t row, const BodyImpulse& on,
                           Workspace& memory) const = 0;
  /// What impulses on all rows, at once, change of all rows.
  virtual void answers(const State& state, std::span<const BodyImpulse> on, std::span<BodyTwist> out,
                       Workspace& memory) const = 0;
  /// Wakes the row, too.
  virtual void push(State& state, size_t row, const BodyImpulse& on, Workspace& memory) const = 0;
  /// Moves all rows about as far as `push` would change their velocities. Momentum stays, angular momentum
  /// about the origin changes by P x v - gained, v the velocity of the row's centre before, where nothing
  /// holds.
  virtual void shift(State& state, size_t row, const BodyImpulse& by, const Vec3& gained,
                     Workspace& memory) const = 0;
};

}  // namespace truestep
