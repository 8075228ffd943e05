// Columns of the system "nbody". Rows of merged bodies are removed; ids identify the bodies.
#pragma once
#include <optional>
#include <span>

#include "engine/core/commands/user_forces.h"

namespace truestep::nbody {

struct Columns {
  enum : State::Column {
    position,
    velocity,
    mass,    ///< kg
    radius,  ///< m
    id,      ///< u64, ascending
    per_body_end,
    parameters = per_body_end,  ///< Parameter
    counters,                   ///< u64: Counter
    push_id,
    push_force,      ///< N
    push_remaining,  ///< s
    drag_id,
    drag_target,     ///< m
    drag_stiffness,  ///< N/m
  };
  static constexpr UserForces kHands{{push_id, push_force, push_remaining},
                                     {drag_id, drag_target, drag_stiffness}};
};
enum class Parameter : uint8_t { gravitational_constant, softening, count };
enum class Counter : uint8_t { collisions, merged, count };

inline double parameter(const State& s, Parameter p) {
  return s.f64(Columns::parameters)[static_cast<size_t>(p)];
}
inline uint64_t& counter(State& s, Counter c) {
  return s.span<uint64_t>(Columns::counters)[static_cast<size_t>(c)];
}
inline uint64_t counter(const State& s, Counter c) {
  return s.span<uint64_t>(Columns::counters)[static_cast<size_t>(c)];
}

struct Body {
  Vec3 x, v;                ///< m, m/s
  double mass, radius = 0;  ///< kg, m
};

State nbody_state(std::span<const Body> bodies, double gravitational_constant, double softening);
/// Row of a body, unless it has merged with another.
std::optional<size_t> row_of(const State& s, uint64_t id);
/// Removes dead rows from the columns of the bodies and from the integration method's per-body columns.
void remove_rows(State& s, std::span<const uint8_t> dead);

}  // namespace truestep::nbody
