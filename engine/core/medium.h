// Rigid bodies in a medium that fills space, such as a liquid of particles. Water answers a body at once: the
// mass that it adds to a light body is more than the body's own, and an exchange from step to step would blow
// up. So a medium is handed the bodies for the whole of its step, moves them on by what it does to them, and
// says what that was; the coupling "immersion" brings them and takes the impulses back.
#pragma once
#include <optional>

#include "engine/geometry/transform.h"
#include "engine/kernels/free_rotation.h"

namespace truestep {

struct Solid;

/// A body for one step of a medium. Its place, orientation, velocity and spin are the medium's idea of it.
struct ImmersedBody {
  const Solid* solid = nullptr;  ///< in the frame of centre and principal axes
  double mass = 0;               ///< kg; 0: nothing moves it but its own velocity
  Vec3 moments;                  ///< kg m^2
  Vec3 place, velocity, spin;    ///< m, m/s, rad/s, in the world
  Quat orientation;
  /// m/s^2, what all else did to it in the step before; none: not known.
  std::optional<Vec3> pull;

  Vec3 impulse, twist;  ///< N s and N m s about its centre that the medium has given it

  Transform frame() const { return {rotation(orientation), place}; }
  /// m/s, of what is at this arm from its centre.
  Vec3 velocity_at(const Vec3& arm) const { return velocity + cross(spin, arm); }

  struct Answer {
    Vec3 velocity, spin;  ///< m/s, rad/s
    Vec3 at(const Vec3& arm) const { return velocity + cross(spin, arm); }
  };
  /// What an impulse and a twist change.
  Answer answer(const Vec3& push, const Vec3& about) const {
    if (!(mass > 0)) return {};
    return {push / mass, free_rotation::spin_of(orientation, about, moments)};
  }
  /// Gives it an impulse and a twist.
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
