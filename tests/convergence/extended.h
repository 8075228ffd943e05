// Order witnesses: the tables of the rows themselves, run with more digits than double has. For high orders,
// double leaves no step size at which the leading error term dominates and rounding does not; with 33 digits
// there are enough. A witness is tied to the product by the end of its motion, which equals the product's to
// rounding at the same steps. What remains of rounding is that of the tables' coefficients, 1e-16: errors are
// taken against the same table with finer steps, which removes the part that is the same for all steps.
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

/// Observed order of the error without its terms in h^0 ... h^dropped, which rounded coefficients leave
/// (1e-16 and below) and which runs of n, 2n, 3n ... steps separate. `dropped` is below every promised order.
double extended_order(const ExtendedStep& step, const ExtendedProblem& problem, int dropped, const Fit& fit);

}  // namespace truestep::test
