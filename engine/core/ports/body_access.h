// Bodies that couplings reach but that are not free rigid bodies in space: links of a tree move in their
// joint coordinates, bodies of the plane stay in it. An impulse (J, T) on a row changes velocities by
//   (dv, dw) = W (J, T)       W: symmetric, positive semidefinite, of all rows at once
// and a position correction (kg m, kg m^2 rad) moves rows by the same amounts. Const like the system that
// owns it.
#pragma once
#include <span>
#include <vector>

#include "engine/core/state/state.h"
#include "engine/core/state/workspace.h"
#include "engine/math/quaternion.h"

namespace truestep {

struct BodyMotion {
  Vec3 place;  ///< m, of the centre of mass
  Quat orientation;
  Vec3 velocity, spin;  ///< m/s and rad/s, world
};
/// N s and N m s about the centre of mass; kg m and kg m^2 rad for corrections.
struct BodyImpulse {
  Vec3 impulse, twist;
  bool none() const { return norm2(impulse) + norm2(twist) == 0; }
};
/// m/s of the centre of mass and rad/s.
struct BodyTwist {
  Vec3 velocity, spin;
};

class BodyAccess;
class BodyCarrier;  // core/ports/body_carrier.h
class BodySleep;    // core/ports/body_sleep.h

/// The system behind bodies whose columns do not say everything.
class BodyOwner {
 public:
  virtual ~BodyOwner() = default;
  /// Wakes the body in that row and everything it rests on, carries or is joined to. Cheap when it is awake.
  virtual void wake(State& state, size_t row) const = 0;
  /// Access to rows that are not free bodies in space; null: they are free.
  virtual const BodyAccess* access() const { return nullptr; }
  /// Null: they cannot be led to given motions (free bodies need none for that).
  virtual const BodyCarrier* carrier() const { return nullptr; }
  /// Null: they never fall asleep.
  virtual const BodySleep* sleep() const { return nullptr; }
};

class BodyAccess : public BodyOwner {
 public:
  const BodyAccess* access() const final { return this; }
  /// Bodies of the plane are prisms along z: their corners are edges, and one point of each is enough.
  enum class Space : uint8_t { space, plane };
  virtual Space space() const { return Space::space; }
  /// Called before use: discards what `memory` holds of other states, or of this one before a step.
  virtual void forget(Workspace& memory) const {}
  /// Number of rows; constant.
  virtual size_t count() const = 0;
  /// Index into the port's forms.
  virtual uint32_t form(const State& state, size_t row) const = 0;
  virtual BodyMotion motion(const State& state, size_t row) const = 0;
  /// Motions of all rows.
  virtual void motions(const State& state, std::span<BodyMotion> out, Workspace& memory) const = 0;
  /// How an impulse on a row changes that row.
  virtual BodyTwist answer(const State& state, size_t row, const BodyImpulse& on,
                           Workspace& memory) const = 0;
  /// How simultaneous impulses on all rows change all rows.
  virtual void answers(const State& state, std::span<const BodyImpulse> on, std::span<BodyTwist> out,
                       Workspace& memory) const = 0;
  /// Applies an impulse; wakes the row.
  virtual void push(State& state, size_t row, const BodyImpulse& on, Workspace& memory) const = 0;
  /// Moves all rows by about as much as `push` would change their velocities. Where nothing holds them,
  /// momentum is kept, and angular momentum about the origin changes by P x v - gained, v the velocity of the
  /// row's centre before.
  virtual void shift(State& state, size_t row, const BodyImpulse& by, const Vec3& gained,
                     Workspace& memory) const = 0;
};

}  // namespace truestep
