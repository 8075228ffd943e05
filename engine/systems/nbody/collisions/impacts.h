// A step of bodies that collide. Contact is found where the method's own path touches: adaptive methods are
// stopped on their dense output, others repeat the step with the length at which the two balls touch (the
// path of a one-step method is what it gives for every length). There the collision is resolved, and the
// rest of the step is a step of its own.
// Bodies that keep touching (a flight shorter than 1/64 of the step) rest against each other until the step
// ends (supported_field.h), where they lose what speed of approach they have gained and are put back to where
// they touch. A step has a limited number of collisions; beyond it bodies that touch merely lose their
// speed of approach, which is counted (nbody.cc warns of it).
// More than kEveryPair bodies of a fixed-step method whose mutual attraction during a step is nothing to
// their speeds are dealt with pair by pair (collisions.h): there a repeated step of all is not paid for.
#pragma once
#include "engine/core/equations/integrator.h"
#include "engine/systems/nbody/nbody_def.h"
#include "engine/systems/nbody/nbody_state.h"

namespace truestep::nbody {

/// What a state with collisions remembers of them, besides the counters: column "impacts".
enum class Impact : uint8_t {
  left_over,      ///< touches that a step had no room for
  largest_ratio,  ///< of a fixed step to the time sqrt(R^3 / (G m)) of the pair that touched
  count
};
inline constexpr std::string_view kImpacts = "impacts";

inline double& impact(State& s, Impact which) {
  return s.f64(s.at(kImpacts))[static_cast<size_t>(which)];
}
inline double impact(const State& s, Impact which) {
  return s.f64(s.at(kImpacts))[static_cast<size_t>(which)];
}

void step_with_collisions(const ForceField& field, const Integrator& method, const IntegratorOptions& options,
                          const CollisionsDef& def, State& s, const StepInput& in);

}  // namespace truestep::nbody
