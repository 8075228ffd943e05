// What a field can do whose potential is a sum of terms that cancel: say how large they are, so that nobody
// takes their rounding for a change of the potential.
#pragma once
#include "engine/core/state.h"

namespace truestep {

class PotentialTerms {
 public:
  virtual ~PotentialTerms() = default;
  /// Sum of the magnitudes of what cancels in ForceField::potential, J; |V| itself counts anyway.
  virtual double potential_terms(const State& state) const = 0;
};

}  // namespace truestep
