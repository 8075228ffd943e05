// What a system of points may offer in its ports: how all of them answer to impulses on some, where its
// method solves for them together. Points of other systems answer each by its own mass.
#pragma once
#include <span>

#include "engine/core/system.h"

namespace truestep {

class AnswersImpulses {
 public:
  virtual ~AnswersImpulses() = default;
  /// What impulses (N s, 3 per point), had forces given them in the step input.h that ends in `state`, would
  /// have changed there: velocities by `dv` (m/s, 3 per point), places by h dv. Linear, symmetric and never
  /// negative in the impulses. `again`: with the matrix of the first call in this workspace.
  enum class Answer : uint8_t { first, again };
  virtual void answer(State& state, const StepInput& input, Answer which, std::span<const double> impulses,
                      std::span<double> dv) const = 0;
};

/// The system's answers; null where its points answer each for itself.
inline const AnswersImpulses* answers_together(const System& system) {
  return system.ports().answers;
}

}  // namespace truestep
