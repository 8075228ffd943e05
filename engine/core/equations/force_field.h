// The right-hand side that integrators see: d/dt (x, v) = (G(x) v, M^-1 f(x, v, t)). x is the state's column
// "position" (rows x position width), v its column "velocity" (rows x velocity width), both f64 and flat.
// G is the identity for points; orientations supply their own.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "engine/base/parallel.h"
#include "engine/core/state/state.h"
#include "engine/core/state/workspace.h"

namespace truestep {

class BlockSparse;        // math/: matrix of small dense blocks
class FieldLinearSolver;  // core/equations/linear_solver.h
class LaggedDissipation;  // core/equations/lagged_dissipation.h
class PointForces;        // core/equations/point_forces.h
class SofteningForces;    // core/equations/softening_forces.h
class StiffnessBound;     // core/equations/stiffness_bound.h

/// Where a right-hand side is evaluated. x and v are an integrator's stage values; the rest of the state
/// (masses, rest lengths, drag targets ...) is the one at the step's start.
struct Phase {
  double t = 0;  ///< s
  std::span<const double> x;
  std::span<const double> v;
  const State& state;
};

/// Scratch and threads for an evaluation.
struct Evaluation {
  Workspace& workspace;
  const ThreadArena& arena;
};

/// What an acceleration depends on; splitting methods need to know.
enum class Dependence : uint8_t { position, position_and_velocity };

class ForceField {
 public:
  virtual ~ForceField() = default;

  /// Columns "position" (Role::position) and "velocity" (Role::velocity), then whatever else the field needs.
  virtual State initial_state() const = 0;

  /// a = M^-1 f(x, v, t), as long as v. Rows with inverse mass 0 get 0.
  virtual void acceleration(const Phase& at, std::span<double> a, Evaluation& e) const = 0;
  /// dx/dt = G(x) v, as long as x: either written to `rate`, which is then returned, or the velocity itself
  /// when G is the identity, which is the default.
  virtual std::span<const double> position_rate(const Phase& at, std::span<double> rate, Evaluation& e) const;
  /// Brings a stepped (x, v) back to its manifold (unit quaternions ...). The default does nothing.
  virtual void project(std::span<double> x, std::span<double> v, const State& state) const {}

  virtual Dependence dependence() const = 0;
  /// V(x, t) in J if the forces are conservative (dissipative parts left out); empty otherwise.
  virtual std::optional<double> potential(const Phase& at, Evaluation& e) const { return std::nullopt; }
  /// J, the size of terms of V that cancel, so that their rounding is not mistaken for a change of V; |V|
  /// itself is always included.
  virtual double cancelling_terms(const State& state) const { return 0; }
  /// R(x, v, t) in W of all forces not in the potential (damping, air, prescribed forces), so that f = -dV/dx
  /// - dR/dv; empty when there is no such function or it is not implemented.
  virtual std::optional<double> dissipation(const Phase& at, Evaluation& e) const { return std::nullopt; }
  /// T in J.
  virtual double kinetic(const Phase& at, Evaluation& e) const = 0;

  // --- what implicit methods need, all optional

  virtual bool has_jacobian() const { return false; }
  /// True when df/dx and df/dv are symmetric, so that conjugate gradients apply.
  virtual bool symmetric_jacobian() const { return false; }
  /// Inverse mass per row, 0 for a row that is held (its velocity is prescribed). f = a / inverse mass.
  virtual std::span<const double> inverse_mass(const State& state) const { return {}; }
  /// Gives both matrices their pattern (block rows = rows, block size = velocity width). The pattern
  /// depends only on what `pattern_version` names.
  virtual void jacobian_pattern(const State& state, BlockSparse& dfdx, BlockSparse& dfdv) const;
  virtual uint64_t pattern_version(const State& state) const { return 0; }
  /// Overwrites the values of df/dx (N/m) and df/dv (N s/m) at `at`; exact, including compressed springs.
  virtual void jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv, Evaluation& e) const;

  /// The same without the parts that make -df/dx indefinite (compressed springs push sideways), for methods
  /// that solve with M - h^2 df/dx and would fail on them. The default is the exact one.
  virtual void definite_jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv, Evaluation& e) const {
    jacobian(at, dfdx, dfdv, e);
  }

  /// The field's own solver for the linear systems of implicit methods, for one user; null: none. It refers
  /// to this field.
  virtual std::unique_ptr<FieldLinearSolver> linear_solver() const;

  /// What else implicit methods may use, or null.
  virtual const LaggedDissipation* lagged_dissipation() const { return nullptr; }
  virtual const SofteningForces* softening_forces() const { return nullptr; }
  virtual const StiffnessBound* stiffness_bound() const { return nullptr; }
  virtual const PointForces* point_forces() const { return nullptr; }

  /// Largest angular frequency (1/s) and damping rate (1/s) of the linearised field, for step suggestions.
  struct Stiffness {
    double omega = 0;
    double damping = 0;
  };
  virtual std::optional<Stiffness> stiffness(const State& state) const { return std::nullopt; }
};

}  // namespace truestep
