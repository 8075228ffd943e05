// Which bodies are stopped at their time of impact, in the plane and in space. A body that moves by less than
// half of its inner radius in a step cannot lose touch with what it overlaps at the step's end; a faster one
// goes as far as its shape touches something, or, where it touched from the start, as far as its core does:
// it may slide and turn on what it lies on, and goes through nothing.
#pragma once

namespace truestep {

/// Radius of a fast body's core, as a share of the body's inner radius.
inline constexpr double kToiCore = 0.25;

/// Whether a body with this inner radius (m) is to be swept; `travel`: m, a bound for all of its points.
inline bool may_pass_through(double travel, double inner) {
  return travel >= 0.5 * inner;
}

}  // namespace truestep
