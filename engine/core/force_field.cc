#include "engine/core/force_field.h"

#include <algorithm>

#include "engine/base/errors.h"

namespace truestep {

void ForceField::position_rate(const Phase& at, std::span<double> rate, Evaluation&) const {
  std::copy(at.v.begin(), at.v.end(), rate.begin());
}

void ForceField::jacobian_pattern(const State&, BlockSparse&, BlockSparse&) const {
  throw Error("no_jacobian", "this force field has no Jacobian");
}

void ForceField::jacobian(const Phase&, BlockSparse&, BlockSparse&, Evaluation&) const {
  throw Error("no_jacobian", "this force field has no Jacobian");
}

}  // namespace truestep
