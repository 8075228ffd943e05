// First-order ordinary differential equations, y' = f(t, y), as integration methods see them: ode systems and
// studies pass them directly, force fields through an adapter (y = positions, then velocities). One virtual
// call evaluates all components. Jacobians are optional; without one, methods form coloured finite
// differences on the pattern given by `jacobian_shape`.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace truestep {

class LinearSolver;  // core/equations/linear_solver.h

/// Where entries of a square matrix may differ from 0, and in which order their values are stored.
struct MatrixShape {
  enum class Kind : uint8_t {
    dense,   ///< n * n values, column by column
    banded,  ///< column by column, lower + upper + 1 values each: entry (i, j) at j * (lower + upper + 1) +
             ///< upper + i - j
    sparse  ///< compressed columns: rows[column_start[j] ... column_start[j + 1]) ascending, values alongside
  } kind = Kind::dense;
  size_t lower = 0, upper = 0;            ///< banded: diagonals below and above the main one
  std::span<const int32_t> column_start;  ///< sparse: n + 1 offsets into `rows`
  std::span<const int32_t> rows;

  size_t values(size_t n) const {
    return kind == Kind::dense ? n * n : kind == Kind::banded ? n * (lower + upper + 1) : rows.size();
  }
};

/// Second-order equations behind a right-hand side: y = (x, v), x' = v, v' = a(t, x, v), each half as long.
/// Methods that know the structure (symplectic, Nystroem, Newmark ...) need it; implicit ones solve systems
/// of half the size.
class SecondOrder {
 public:
  virtual ~SecondOrder() = default;
  /// a(t, x, v), as long as x.
  virtual void acceleration(double t, const double* x, const double* v, double* a) const = 0;
  /// False: `acceleration` may be called with v = null.
  virtual bool depends_on_velocity() const = 0;
  /// Shape of both da/dx and da/dv.
  virtual MatrixShape shape() const { return {}; }
  virtual bool has_jacobian() const { return false; }
  /// Inverse masses, one for three rows, that leave da/dx and da/dv symmetric once rows are divided by them
  /// (0: the rows are zero); the entries of a sparse shape are then whole blocks of 3 x 3. Empty: not
  /// symmetric.
  virtual std::span<const double> symmetric_in() const { return {}; }
  /// Overwrites the values of da/dx and da/dv in the order of `shape`.
  virtual void jacobian(double t, const double* x, const double* v, double* dadx, double* dadv) const {}

  /// A stage of an implicit method, u = u0 + g a(t, x0 + s u, u); arrays as long as v.
  struct Stage {
    double t = 0, g = 0, s = 0;
    const double *x0 = nullptr, *u0 = nullptr;
    double tolerance = 0;  ///< relative
  };
  /// Solves it by a method of its own, for steps that cannot be shortened and on which Newton's method
  /// failed. False: no such method, or no solution.
  virtual bool solve_stage(const Stage& stage, double* u) const { return false; }
  /// Allocates what `solve_stage` needs.
  virtual void reserve_stage() const {}
};

class RightHandSide {
 public:
  virtual ~RightHandSide() = default;

  /// Number of equations; constant during an integration.
  virtual size_t size() const = 0;
  /// dydt = f(t, y). The arrays do not overlap.
  virtual void rate(double t, const double* y, double* dydt) const = 0;

  /// y += h f(t, y) in one pass over y, for equations limited by memory rather than arithmetic. False: not
  /// supported, y is unchanged.
  virtual bool euler_in_place(double t, double h, double* y) const { return false; }

  virtual MatrixShape jacobian_shape() const { return {}; }
  virtual bool has_jacobian() const { return false; }
  /// Overwrites the values of df/dy in the order of `jacobian_shape`.
  virtual void jacobian(double t, const double* y, double* values) const {}
  /// What a message calls component i of y.
  virtual std::string name_of(size_t i) const { return "component " + std::to_string(i); }
  /// True: f does not depend on t. False: Rosenbrock methods difference df/dt.
  virtual bool autonomous() const { return false; }

  /// An upper bound of the largest |eigenvalue| of df/dy at (t, y), 1/s, when cheaply known; empty: methods
  /// that need it use power iteration.
  virtual std::optional<double> spectral_radius(double t, const double* y) const { return std::nullopt; }

  /// The second-order equations behind this, or null. Implicit methods then ask for their derivatives and
  /// never for df/dy.
  virtual const SecondOrder* second_order() const { return nullptr; }

  /// A solver of its own for (I - z J) x = b, or null; `linearise` moves it to (t, y). Methods then ask for
  /// no derivatives.
  virtual LinearSolver* linear_solver() const { return nullptr; }
  virtual void linearise(double t, const double* y) const {}
};

}  // namespace truestep
