// Columns of an ode system's state in their order: everything that influences a later step.
#pragma once
#include "engine/core/state/state.h"

namespace truestep::ode {

struct OdeColumns {
  enum Index : State::Column {
    kStates,       ///< y, Role::position
    kTracers,      ///< x, y, z of every tracer, m, Role::position
    kParameters,   ///< values of all parameters
    kCarry,        ///< proposed next internal step, error of the last one
    kEventCounts,  ///< u64, times that each event has happened
    kEventSigns,   ///< i32, side of zero on which the guard of each `when` was last seen, 0: not since it
    kStopped,      ///< 1 and the time, once an event has stopped the system
    kInvariantsAtStart,  ///< value of each invariant at t = 0
    kWork,               ///< u64: internal steps, rejected ones, right-hand sides, Jacobians
    kMemory,             ///< the method's memory of earlier steps, NaN at the front: empty
    kTrail,              ///< what is drawn: for every body its present point, then past ones, newest first
    kResting  ///< i32, only where events can rest: per guard the side of zero that its contact pushes to, 0:
              ///< it does not rest
  };
};

/// Indices in the column of work.
enum OdeWork : size_t { kOdeSteps, kOdeRejected, kOdeRates, kOdeJacobians, kOdeWorkCounters };

}  // namespace truestep::ode
