// Newton's method for the equation of one stage of an implicit method in the velocity u,
//   M (u - u0) = g f(x, u, t),  x = x0 + s u,
// for any g and s, so that every implicit method can use it (implicit Euler: u0 = v, x0 = x, g = s = h).
// Where the forces are f = -dV/dx - dR/du, its solutions are stationary points of the incremental potential
//   phi(u) = 1/2 |u - u0|^2_M + g/s V(x0 + s u) + g R(x, u)
// (Kharevych et al. 2006, "Geometric, variational integrators for computer animation"; Gast, Schroeder 2015,
// "Optimization integrator for large time steps"), which a line search decreases; R is taken at the iterate's
// position, so phi falls along every direction given by A, made definite if necessary. What A lacks (the
// asymmetric derivatives of damping and air by position) is added by conjugate residuals as soon as that
// halves the residual. Fields without a potential are judged by the residual norm alone. When cloth buckles,
// R changes so much with the position that the iteration does not converge: then R is taken at x0, which
// gives phi a minimum that a line search always finds, and Newton's method on the full equations continues
// from there. If that does not converge, the minimum is the solution. If forces are nearly rigid, (omega h)^2
// > 1e7, the iteration starts with softer ones; where that finds no solution, the tensions become unknowns
// (stage_newton_tensions.cc).
#pragma once
#include "engine/core/equations/lagged_dissipation.h"
#include "engine/core/equations/softening_forces.h"
#include "engine/integrators/implicit/implicit_system.h"
#include "engine/integrators/implicit/newton/line_search.h"

namespace truestep {

struct StageEquation {
  double t = 0;                ///< s, time at which the force is evaluated
  double g = 0;                ///< s, factor of the force
  double s = 0;                ///< s, factor of the velocity in the position
  std::span<const double> x0;  ///< m
  std::span<const double> u0;  ///< m/s
  /// Where the iteration may end once the forces' own rounding hides the rest of the residual: `rounding`
  /// ends there, as further corrections move nothing by more than rounding if the mass counts; `correction`
  /// goes on until Newton's corrections are small relative to u, for equilibria, whose softest modes are
  /// negligible next to the stiffest ones.
  enum class End : uint8_t { rounding, correction } end = End::rounding;
};

/// What the last solution took; kept in the workspace under kNewtonReport for tests and benchmarks.
struct NewtonReport {
  static constexpr int kKept = 64;
  int iterations = 0;
  int definite = 0;              ///< of them, with a fraction of the definite Jacobian
  int solves = 0;                ///< of linear systems with a new matrix
  int evaluations = 0;           ///< of the forces
  int softened = 0;              ///< of the iterations, with softened forces
  bool held = false;             ///< damping and air stayed lagged at x0
  double target = 0;             ///< residual norm required by the tolerance
  double floor = 0;              ///< residual norm due to rounding, 0: never needed
  double last = 0;               ///< residual norm at the end
  double residuals[kKept] = {};  ///< norms before each iteration and after the last, the first of them
};
inline constexpr std::string_view kNewtonReport = "integrator.newton";

class StageNewton {
 public:
  StageNewton(Motion& m, const IntegratorOptions& options);

  /// u: a guess in, the solution out; held rows keep theirs. Instability when no solution is found.
  /// Converged: sqrt(sum |r|^2 / m) <= newton_tolerance times its first value or sqrt(sum m |u0|^2),
  /// whichever is larger, or at the rounding of the forces, where better cannot be told from worse: A >= g s
  /// K, so a residual of g |K| eps |x| is a change of position by s |u| = eps |x|. The report is valid until
  /// the next call with the same workspace.
  const NewtonReport& solve(const StageEquation& equation, std::span<double> u);

 private:
  enum class Merit : uint8_t { incremental_potential, residual };
  enum class Search : uint8_t { descent, any_solution };
  enum class Lag : uint8_t { iterate, held };
  /// nullptr: converged; otherwise why not.
  using Failure = const char*;

  Failure find(double tolerance, const StageEquation& eq, std::span<double> u);
  double softer(const StageEquation& eq) const;
  void full_step_unasked(const StageEquation& eq, std::span<double> u);
  Failure stiffen(double share, double target, const StageEquation& eq, std::span<double> u);
  Failure approach(double share, const StageEquation& eq, std::span<double> u);
  Failure follow_tensions(const StageEquation& eq, std::span<double> u);
  void solve_under_tensions(const StageEquation& eq, std::span<const double> u);
  /// Whether a further correction is small relative to u, or moves nothing by more than rounding.
  bool settled(const StageEquation& eq, std::span<const double> u, int iteration);
  Failure iterate_to(double target, int most, const StageEquation& eq, std::span<double> u);
  Failure solve_held(const StageEquation& eq, std::span<double> u);
  void accelerate(double t, std::span<const double> x, std::span<const double> u, std::span<double> a);
  void move(const StageEquation& eq, std::span<const double> u);
  void keep_on_surfaces(std::span<double> u);

  void choose_start(const StageEquation& eq, std::span<double> u);
  double evaluate(const StageEquation& eq, std::span<const double> u);
  double residual_on_surfaces();
  double value(const StageEquation& eq, std::span<const double> u);
  bool iterate(const StageEquation& eq, std::span<double> u, double accuracy, Search kind);
  bool leap(const StageEquation& eq, std::span<double> u, double accuracy);
  bool full_step(const StageEquation& eq, std::span<double> u, double accuracy);
  void slope_along(const StageEquation& eq, std::span<const double> u, std::span<const double> z,
                   std::span<double> q);
  double rounding_of_value(const StageEquation& eq, double magnitude);
  bool search(const StageEquation& eq, std::span<double> u, double slope);
  void record();
  std::span<const double> rate_position() const;
  [[noreturn]] void fail(const std::string& why);

  Motion& m_;
  const IntegratorOptions& options_;
  size_t n_;
  ImplicitSystem system_;
  NewtonReport& report_;
  Merit merit_ = Merit::incremental_potential;
  const LaggedDissipation* lagging_;  // of the field, if supported
  const SofteningForces* softening_;  // the same
  Lag lag_ = Lag::iterate;
  double first_ = 0;      // norm of the residual at the start
  double definite_ = 0;   // fraction of the definite Jacobian in the last direction's matrix
  double norm_ = 0;       // of the residual at the last evaluation
  double magnitude_ = 0;  // sum of |terms| of the last value
  std::span<double> a_, b_, d_, x_, lagged_, trial_, start_, leap_, guess_;
  double last_share_ = 1;  // of its direction that the last line search took
  // Conjugate residuals.
  static constexpr size_t kMostDirections = 12;
  std::span<double> a_near_, x_near_, rest_, whole_;
  size_t most_;
  std::span<double> krylov_;
};

}  // namespace truestep
