// Which bodies are stopped at their time of impact, in the plane and in space. A body that moves by less than
// half of its inner radius in a step cannot pass what it overlaps at the step's end. A faster body moves
// until its shape touches something or, if it touched from the start, until its core does: it may slide and
// turn on what it rests on, but passes through nothing.
#pragma once

namespace truestep {

/// Radius of a fast body's core, as a fraction of the body's inner radius.
inline constexpr double kToiCore = 0.25;

/// Whether a body with this inner radius (m) must be swept; `travel`: m, a bound for all of its points.
inline bool may_pass_through(double travel, double inner) {
  return travel >= 0.5 * inner;
}

}  // namespace truestep
