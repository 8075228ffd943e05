// Order witnesses: the rows' own tables run in more digits than double has. Where an order is high, double
// leaves no step length at which the leading term of the error rules and rounding does not; with 33 digits
// there are enough. A witness is tied to the product by its end of the motion, which is the product's own to
// rounding at the same steps. What remains of rounding is that of the tables' coefficients, 1e-16: errors are
// taken against the same table with finer steps, which drops its part that is the same for all steps.
#pragma once
#include <functional>
#include <string_view>
#include <vector>

#include "engine/integrators/explicit/tableau.h"
#include "engine/integrators/explicit/tableau_nystrom.h"
#include "engine/integrators/symplectic/splitting.h"
#include "tests/convergence/equations.h"
#include "tests/convergence/problems.h"

namespace truestep::test {

/// A convergence problem over Extended; y = (x, v).
struct ExtendedProblem {
  const char* name;
  Problem (*in_double)();
  size_t nx, nv;
  bool moving;  ///< the acceleration depends on velocity
  void (*acceleration)(const Extended* x, const Extended* v, Extended* a);
  void (*rate)(const Extended* x, const Extended* v, Extended* dx) = nullptr;  ///< null: x' = v
  void (*project)(Extended* x) = nullptr;                                      ///< after every step, or null
};
std::vector<ExtendedProblem> extended_problems();

/// One step of length h in place.
using ExtendedStep = std::function<void(const ExtendedProblem&, Extended h, Extended* y)>;
ExtendedStep extended(const Tableau& t);
ExtendedStep extended(const NystromTableau& t);
ExtendedStep extended(const Splitting& s);
/// Collocation at the nodes of ias15, solved to 1e-28.
ExtendedStep extended_collocation(const std::array<double, 8>& nodes);

/// y at the end of `steps` equal steps from the problem's start.
std::vector<Extended> extended_end(const ExtendedStep& step, const ExtendedProblem& problem, size_t steps);

/// Observed order of the error without its parts that go like h^0 ... h^dropped, which rounded coefficients
/// leave (1e-16 and below) and which n, 2n, 3n ... steps tell apart. `dropped` is below every promise.
double extended_order(const ExtendedStep& step, const ExtendedProblem& problem, int dropped, const Fit& fit);

}  // namespace truestep::test
