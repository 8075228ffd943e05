// The two ways in which implicit methods solve their equations: sparse, with the field's own Jacobian, and
// dense, with differences, for small systems.
#pragma once
#include "engine/integrators/motion.h"

namespace truestep {

/// Column with one count: steps whose damping and air stayed lagged at the step's start (stage_newton.h).
/// Only fields that support this have it.
inline constexpr std::string_view kHeldSteps = "integrator.held_steps";

/// Flag in the workspace: something else moves points after each step, and a stage that Newton's method does
/// not solve is refused. Minimised instead, it would turn what was stretched into motion.
inline constexpr std::string_view kPointsAreMoved = "integrator.points_are_moved";

/// For fields with a Jacobian and dx/dt = v.
void implicit_euler_sparse(Motion& m, const IntegratorOptions& options);
void linear_implicit_euler_sparse(Motion& m, const IntegratorOptions& options);
/// Allocates what a step of implicit_euler_sparse needs, for methods that fall back on it in later steps.
void reserve_implicit_euler_sparse(Motion& m, const IntegratorOptions& options);

/// Newton's method to its tolerance, or exactly one Newton step.
enum class NewtonSteps : uint8_t { converged, one };
/// For at most kDenseUnknowns components of x and v together; any G(x).
void implicit_euler_dense(Motion& m, const IntegratorOptions& options, NewtonSteps steps);

inline constexpr size_t kDenseUnknowns = 64;
/// Unknowns of a step up to which fields without a Jacobian use differences: matrices of 50 to 200 MB.
inline constexpr size_t kMostDifferences = 2500;

}  // namespace truestep
