// Checks a state from outside: drags and pushes must act on points that exist.
#include "engine/systems/mass_spring/mass_spring.h"

namespace truestep::mass_spring {

void MassSpring::check(StateCheck& check, double) const {
  using C = MassSpringColumns;
  const size_t points = check.state().rows(C::position);
  check.together({C::drag_row, C::drag_target, C::drag_stiffness})
      .together({C::push_row, C::push_force, C::push_remaining});
  for (const auto column : {C::drag_row, C::push_row}) {
    for (const uint32_t row : check.state().span<uint32_t>(column))
      check.require(row < points, "the row of a push or drag");
  }
}

}  // namespace truestep::mass_spring
