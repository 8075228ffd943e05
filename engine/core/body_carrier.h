// Bodies that something else moves, a bone or a path: put where they are wanted, with the velocities wanted.
// Free bodies simply are there then; those with an access go as near as what joins them lets them, where
// their owner knows how (BodyCarrier).
#pragma once
#include "engine/core/body_port.h"

namespace truestep {

class BodyCarrier {
 public:
  virtual ~BodyCarrier() = default;
  /// Puts rows, where `given` is 1, as near to these motions as what joins them lets them.
  virtual void carry(State& state, std::span<const BodyMotion> to, std::span<const uint8_t> given,
                     Workspace& memory) const = 0;
};

/// Whether `carry` can do anything with such bodies.
inline bool can_be_carried(const BodyPort& port) {
  return !port.access() || dynamic_cast<const BodyCarrier*>(port.owner);
}

/// Rows scratch of carry: one each of all rows.
struct CarriedBodies {
  std::vector<BodyMotion> motions;
  std::vector<uint8_t> given;
  void start(size_t rows) { motions.resize(rows), given.assign(rows, 0); }
  void want(size_t row, const BodyMotion& motion) { motions[row] = motion, given[row] = 1; }
};

/// Puts rows of `port` into the wanted motions and wakes them; those of bodies that can be carried.
inline void carry(State& state, const BodyPort& port, const CarriedBodies& wanted, Workspace& memory) {
  if (port.access()) {
    dynamic_cast<const BodyCarrier&>(*port.owner).carry(state, wanted.motions, wanted.given, memory);
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
