#include "engine/core/equations/force_field.h"

#include "engine/base/errors.h"
#include "engine/core/equations/linear_solver.h"

namespace truestep {

std::span<const double> ForceField::position_rate(const Phase& at, std::span<double>, Evaluation&) const {
  return at.v;
}

void ForceField::jacobian_pattern(const State&, BlockSparse&, BlockSparse&) const {
  throw Error("no_jacobian", "this force field has no Jacobian");
}

void ForceField::jacobian(const Phase&, BlockSparse&, BlockSparse&, Evaluation&) const {
  throw Error("no_jacobian", "this force field has no Jacobian");
}

std::unique_ptr<FieldLinearSolver> ForceField::linear_solver() const {
  return nullptr;
}

}  // namespace truestep
