// The initial value problems of the work-precision benchmark, each with the solvers that this program can run
// on it: ours through the virtual interface that the product uses, Boost.odeint on the problem's own type (so
// that its loops are inlined), CVODE from its C interface.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/core/equations/right_hand_side.h"

namespace truestep::bench {

using Vector = std::vector<double>;

/// Interval and error measure of a problem.
struct Case {
  std::string name;
  double t_end = 0;
  Vector start;
  double first_step = 1e-4;   ///< for the solvers that ask for one
  double absolute_scale = 1;  ///< absolute tolerance as a fraction of the relative one
  std::function<double(const double*)> error = {};
  double stiffness = 0, damping = 0;  ///< chains: of a link
};

struct Outcome {
  Vector end;                ///< empty: the solver gave up
  uint64_t evaluations = 0;  ///< of the right-hand side, those for differenced Jacobians included
};

struct Solver {
  std::string name, side;  ///< side: ours, odeint, CVODE
  int from = 2, to = 12;   ///< tolerances 10^-from ... 10^-to
  std::function<Outcome(double tolerance)> run = {};
};

struct Problem {
  Case at;
  std::vector<Solver> solvers;
};

/// All of them, in the order of the report.
std::vector<Problem> problems();

/// A method of ours by name; f and at outlive the solver.
Solver ours(const char* name, const RightHandSide& f, const Case& at, int from, int to);
/// CVODE's BDF with the Jacobian that f has or else CVODE's own differences, dense.
Solver cvode_bdf(const RightHandSide& f, const Case& at, int from, int to);
/// CVODE's Adams methods with functional iteration.
Solver cvode_adams(const RightHandSide& f, const Case& at, int from, int to);
/// CVODE's BDF on a hanging chain: unknowns in an order that makes a narrow band.
Solver cvode_chain(const Case& at, int from, int to);

}  // namespace truestep::bench
