// Cost estimate of a system of springs, from counts alone.
#include <algorithm>
#include <cmath>

#include "engine/integrators/table/integrators.h"
#include "engine/systems/mass_spring/mass_spring.h"

namespace truestep::mass_spring {

namespace {

/// Of the usual stiff scene.
constexpr double kNewton = 3;
constexpr double kSheet = 2, kLattice = 8;  // springs per point: more than in a tree, more than in a sheet

double springs_each(const MassSpringCounts& n) {
  return n.springs / std::max(n.points, 1.0);
}

// Measured. A solve keeps matrix and factor: trees (hair, ropes) have no fill-in, sheets a share of
// log2(points) in the elimination order used, lattices in space the cube root of the points.
double solver_bytes(const MassSpringCounts& n) {
  const double levels = std::log2(std::max(n.points, 1.0));
  if (springs_each(n) < kSheet) return 300 * n.points + 1200 * n.springs;
  if (springs_each(n) < kLattice) return 300 * n.points + (1100 + 3.5 * levels * levels) * n.springs;
  return 300 * n.points + (1100 + 60 * std::cbrt(n.points)) * n.springs;
}

// Factorising a sheet takes points^1.5 operations, and leaves the caches as it grows: measured points^1.75. A
// tree takes time proportional to its springs. Springs that skip a neighbour (more than four a point) double
// the width of separators, and the work grows with its cube. Points in contact make a step solve again.
double solver_seconds(const MassSpringCounts& n, bool touches) {
  const double tree = 2.2e-7 * n.springs, each = springs_each(n);
  if (each < kSheet) return (touches ? 1.7 : 1) * tree;
  const double root = std::sqrt(n.points);
  return tree + (touches ? 3.5 : 1) * (each > 4.5 ? 2.0e-8 : 3.1e-9) * n.points * root * std::sqrt(root);
}

// Measured at 100 x 100 and 200 x 200 points: an iteration of projective dynamics is the solves with its
// factor, one of vertex block descent a visit to every spring from both ends.
double descent_seconds(const MassSpringCounts& n, std::string_view method, int iterations) {
  const double levels = std::log2(std::max(n.points, 2.0)) / 13.3;
  const double each =
      method == "projective_dynamics" ? 1.3e-7 * levels * n.points : 3.6e-8 * n.springs + 1e-8 * n.points;
  return iterations * each;
}

bool solves(const Integrator* method) {
  return !method || method->kind == Integrator::Kind::implicit;
}

}  // namespace

double step_seconds(const MassSpringDef& d, const Integrator* method) {
  const MassSpringCounts n = mass_spring_counts(d);
  if (method && (method->name == "projective_dynamics" || method->name == "vertex_block_descent"))
    return descent_seconds(n, method->name, d.choice().options.descent_iterations);
  // Newton's method solves once a step or more.
  const double iterations = method && method->name == "implicit_euler" ? kNewton : 1;
  if (solves(method)) return iterations * solver_seconds(n, !d.colliders.empty());
  // Measured: one evaluation, of which adaptive methods need many.
  const double evaluations = method->stepping == Integrator::Stepping::adaptive ? 20 : 2;
  return 1.5e-8 * n.points + 3.5e-9 * evaluations * n.springs;
}

AnswersImpulses::Seconds answer_seconds(const MassSpringDef& d) {
  const MassSpringCounts n = mass_spring_counts(d);
  const double per_point = 300 * n.points + 950 * n.springs;
  // A solve reads the factor twice.
  constexpr double kCall = 4e-7, kPerByte = 1.2e-10;
  return {kCall + solver_seconds(n, false), kCall + kPerByte * (solver_bytes(n) - per_point)};
}

Cost mass_spring_cost(const void* def) {
  const auto& d = *static_cast<const MassSpringDef*>(def);
  const MassSpringCounts n = mass_spring_counts(d);
  const Integrator* named = find_integrator(d.choice().name);
  if (named && (named->name == "projective_dynamics" || named->name == "vertex_block_descent")) {
    // One number per pair of points instead of nine; no matrix at all for descent by points.
    const bool factor = named->name == "projective_dynamics";
    return {
        .state_bytes = (factor ? 56.0 : 80.0) * n.points,
        .workspace_bytes = factor ? 500 * n.points + solver_bytes(n) / 4 : 300 * n.points + 300 * n.springs,
        .elements = n.points + n.springs,
        .seconds_per_step = step_seconds(d, named)};
  }
  return {.state_bytes = 56 * n.points,
          .workspace_bytes = solves(named) ? solver_bytes(n) : 75 * n.points + 300 * n.springs,
          .elements = n.points + n.springs,
          .seconds_per_step = step_seconds(d, named)};
}

}  // namespace truestep::mass_spring
