// Bodies moved by something else, such as a bone or a path: placed at given poses with given velocities. Free
// bodies take these exactly; those with an access come as close as their joints allow, if their owner
// supports it (BodyOwner::carrier).
#pragma once
#include "engine/core/ports/body_port.h"

namespace truestep {

class BodyCarrier {
 public:
  virtual ~BodyCarrier() = default;
  /// Moves rows, where `given` is 1, as close to these motions as their joints allow.
  virtual void carry(State& state, std::span<const BodyMotion> to, std::span<const uint8_t> given,
                     Workspace& memory) const = 0;
};

/// Whether `carry` can do anything with such bodies.
inline bool can_be_carried(const BodyPort& port) {
  return !port.access() || port.owner->carrier();
}

/// Scratch of `carry`, with one element per row.
struct CarriedBodies {
  std::vector<BodyMotion> motions;
  std::vector<uint8_t> given;
  void start(size_t rows) { motions.resize(rows), given.assign(rows, 0); }
  void want(size_t row, const BodyMotion& motion) { motions[row] = motion, given[row] = 1; }
};

/// Moves rows of `port` to the wanted motions and wakes them; can_be_carried must hold.
inline void carry(State& state, const BodyPort& port, const CarriedBodies& wanted, Workspace& memory) {
  if (port.access()) {
    port.owner->carrier()->carry(state, wanted.motions, wanted.given, memory);
    return;
  }
  RealColumn<double> place(state, port.position), orientation(state, port.orientation),
      velocity(state, port.velocity), spin(state, port.angular_velocity);
  for (size_t row = 0; row < wanted.given.size(); ++row) {
    if (!wanted.given[row]) continue;
    if (port.owner) port.owner->wake(state, row);
    const BodyMotion& to = wanted.motions[row];
    place.set_vector(row, to.place), orientation.set_quaternion(row, to.orientation);
    velocity.set_vector(row, to.velocity), spin.set_vector(row, to.spin);
  }
}

}  // namespace truestep
