// Rigid bodies in a medium that fills space, such as a liquid of particles. Water responds to a body at once:
// the mass it adds to a light body exceeds the body's own, and an exchange once per step would blow up. So a
// medium is given the bodies for the whole of its step, moves them by the forces it exerts, and reports the
// impulses; the coupling "immersion" passes the bodies in and the impulses back.
#pragma once
#include <optional>

#include "engine/geometry/transform.h"
#include "engine/kernels/rigid/free_rotation.h"

namespace truestep {

struct Solid;

/// A body during one step of a medium. Its position, orientation, velocity and spin are the medium's working
/// copy.
struct ImmersedBody {
  const Solid* solid = nullptr;  ///< in the frame of centre and principal axes
  double mass = 0;               ///< kg; 0: it moves only by its own velocity
  Vec3 moments;                  ///< kg m^2
  Vec3 place, velocity, spin;    ///< m, m/s, rad/s, in the world
  Quat orientation;
  /// m/s^2 from everything else in the previous step; empty: unknown
  std::optional<Vec3> pull;

  Vec3 impulse, twist;  ///< N s and N m s about its centre, given by the medium

  Transform frame() const { return {rotation(orientation), place}; }
  /// m/s, at this arm from its centre
  Vec3 velocity_at(const Vec3& arm) const { return velocity + cross(spin, arm); }

  struct Answer {
    Vec3 velocity, spin;  ///< m/s, rad/s
    Vec3 at(const Vec3& arm) const { return velocity + cross(spin, arm); }
  };
  /// The velocity change from an impulse and a twist.
  Answer answer(const Vec3& push, const Vec3& about) const {
    if (!(mass > 0)) return {};
    return {push / mass, free_rotation::spin_of(orientation, about, moments)};
  }
  /// Applies an impulse and a twist.
  void give(const Vec3& push, const Vec3& about) {
    const Answer by = answer(push, about);
    velocity += by.velocity, spin += by.spin;
    impulse += push, twist += about;
  }
  /// Moves it by its velocities for h s.
  void advance(double h) {
    place += velocity * h;
    orientation = normalized(free_rotation::turn(spin * h) * orientation);
  }
};

}  // namespace truestep
