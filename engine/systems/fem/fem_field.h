// The forces of an elastic body (kernels/fem/cell.h), of gravity, loads, pressure, damping and drags and
// pushes, with their exact derivatives, for every method in the table of integrators.
//   m_a x_a'' = f_a + s load_a + m_a g - damping m_a v_a + hands + pressure - balance_a
// Prescribed components have no acceleration; their velocity is set before each step (fem.cc).
#pragma once
#include "engine/core/commands/user_forces.h"
#include "engine/core/def/build.h"
#include "engine/core/equations/force_field.h"
#include "engine/core/equations/point_forces.h"
#include "engine/kernels/fem/cell.h"
#include "engine/systems/fem/body.h"

namespace truestep::fem {

struct FemColumns {
  enum : State::Column {
    position,
    velocity,
    inverse_mass,  ///< 1/kg, 0: held
    gravity,       ///< m/s^2
    parameters,    ///< Young's modulus (Pa), damping (1/s)
    drag_row,
    drag_target,     ///< m
    drag_stiffness,  ///< N/m
    push_row,
    push_force,      ///< N
    push_remaining,  ///< s
    balance,         ///< N, a row a node in quasi-static motion: the imbalance that a part of a step leaves
    unbalanced,      ///< N, quasi-static motion only: the largest force left by the last step, -1: none
  };
  static constexpr UserForces kHands{{push_row, push_force, push_remaining},
                                     {drag_row, drag_target, drag_stiffness}};
};

class FemField final : public ForceField, public PointForces {
 public:
  FemField(const FemDef& def, const BuildContext& context);

  State initial_state() const override;
  void acceleration(const Phase& at, std::span<double> a, Evaluation& e) const override;
  Dependence dependence() const override { return dependence_; }
  std::optional<double> potential(const Phase& at, Evaluation& e) const override;
  double cancelling_terms(const State& state) const override;
  std::optional<double> dissipation(const Phase& at, Evaluation& e) const override;
  double kinetic(const Phase& at, Evaluation& e) const override;
  bool has_jacobian() const override { return true; }
  bool symmetric_jacobian() const override { return true; }
  std::span<const double> inverse_mass(const State& state) const override;
  void jacobian_pattern(const State& state, BlockSparse& dfdx, BlockSparse& dfdv) const override;
  void jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv, Evaluation& e) const override;
  void definite_jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv, Evaluation& e) const override;
  std::optional<Stiffness> stiffness(const State& state) const override;

  /// For solid elements with pointwise volume, without pressure.
  const PointForces* point_forces() const override { return colours_.points.empty() ? nullptr : this; }
  const PointColours& colours() const override { return colours_; }
  Vec3 free_acceleration(const State& state) const override;
  Vec3 allowed(size_t node, const Vec3& a) const override;
  void point_slopes(const Phase& at, std::span<const double> x_lagged, double h,
                    std::span<const uint32_t> points, std::span<PointSlope> out) const override;

  const Body& body() const { return body_; }
  Material material(const State& state) const;
  CellRule rule(size_t cell) const;
  /// Forces of the elements alone (N, 3 a node); overwrites f.
  void elastic_forces(const Phase& at, std::span<double> f, Evaluation& e) const;
  /// J, of deformation; of gravity, loads and drags.
  double elastic(const Phase& at, const ThreadArena& arena) const;
  double external(const Phase& at) const;
  /// N m, for a shell.
  double flexural_rigidity(const State& state) const;
  /// Factor on loads, and on gravity in quasi-static motion, at time t.
  double load_share(double t) const;
  /// m, size of an element of mean volume.
  double cell_size() const;
  /// N/m, of an element pushed on one of its sides.
  double contact_stiffness(const State& state) const;
  /// Positions of an element's nodes.
  void gather(const double* x, size_t cell, Vec3* out) const;

 private:
  void derivatives(const Phase& at, Definite definite, BlockSparse& dfdx, BlockSparse& dfdv,
                   Evaluation& e) const;
  template <class Work>
  void by_colour(const ThreadArena& arena, Work work) const;
  Vec3 gravity(const Phase& at) const;
  void add_pressure(const Phase& at, std::span<double> f) const;
  void add_pressure_slope(const Phase& at, BlockSparse& dfdx) const;
  void free_axes_only(std::span<double> f) const;
  void colour_points();

  Body body_;
  Law law_;
  double poisson_, second_, youngs_, damping_, load_time_;
  Motion motion_;
  Vec3 gravity_, velocity_;
  std::vector<CopyDef> copies_;
  Dependence dependence_;
  double omega_ = 0;  // 1/s, bound at rest
  PointColours colours_;
  struct Corner {
    uint32_t cell, node;  // index among the cell's nodes
  };
  std::vector<uint32_t> corners_begin_;
  std::vector<Corner> corners_;  // of every node
};

}  // namespace truestep::fem
