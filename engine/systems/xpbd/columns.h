// Columns of an xpbd state.
#pragma once
#include "engine/core/commands/user_forces.h"
#include "engine/core/state/state.h"

namespace truestep::xpbd {

/// Columns of the state, in the order in which they are added.
struct XpbdColumns {
  enum : State::Column {
    position,
    velocity,
    inverse_mass,  ///< 1/kg, 0: held
    stiffness,     ///< a row per Family
    damping,       ///< N s/m: viscous, internal
    gravity,       ///< m/s^2
    drag_row,
    drag_target,     ///< m
    drag_stiffness,  ///< N/m
    push_row,
    push_force,      ///< N
    push_remaining,  ///< s
    tightness,       ///< 1/s^2, q / h^2 of the last substep (kernels/xpbd/chain.h)
    wind,            ///< m/s; only where a scene gives one
  };
  static constexpr UserForces kHands{{push_row, push_force, push_remaining},
                                     {drag_row, drag_target, drag_stiffness}};
};

}  // namespace truestep::xpbd
