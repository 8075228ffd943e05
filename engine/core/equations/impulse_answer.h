// What a system of points may offer in its ports: how all its points respond to impulses on some, when its
// method solves for them together. Otherwise each point responds by its own mass.
#pragma once
#include <span>

#include "engine/core/system.h"

namespace truestep {

class AnswersImpulses {
 public:
  virtual ~AnswersImpulses() = default;
  /// The change that impulses (N s, 3 per point) would have made, had forces applied them during the step
  /// input.h that ends in `state`: velocities by `dv` (m/s, 3 per point), positions by h dv. Linear,
  /// symmetric and positive semidefinite in the impulses. `again`: with the matrix of the first call in this
  /// workspace.
  enum class Answer : uint8_t { first, again };
  virtual void answer(State& state, const StepInput& input, Answer which, std::span<const double> impulses,
                      std::span<double> dv) const = 0;
  /// s on one core, as estimated, of a first call and of each that uses its matrix again.
  struct Seconds {
    double first = 0, again = 0;
  };
  virtual Seconds answer_seconds() const = 0;
};

/// The system's answers; null when each of its points responds for itself.
inline const AnswersImpulses* answers_together(const System& system) {
  return system.ports().answers;
}

}  // namespace truestep
