// Forces on a network of springs (kernels/springs/spring.h, kernels/springs/air.h):
//   m a = m g + sum springs + bending - c_d v + air + drag springs + pushes,
//   V = sum k/2 (l - L)^2 - sum m g . x + ...
// Everything that commands may change is read from the state; the network itself is fixed.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "engine/core/commands/user_forces.h"
#include "engine/core/def/build.h"
#include "engine/core/equations/force_field.h"
#include "engine/core/equations/lagged_dissipation.h"
#include "engine/core/equations/point_forces.h"
#include "engine/core/equations/softening_forces.h"
#include "engine/core/equations/stiffness_bound.h"
#include "engine/kernels/springs/bending.h"
#include "engine/kernels/springs/spring.h"
#include "engine/systems/mass_spring/network.h"
#include "engine/systems/mass_spring/spring_schedule.h"

namespace truestep::mass_spring {

/// Columns of the state, in the order in which initial_state adds them.
struct MassSpringColumns {
  enum : State::Column {
    position,
    velocity,
    inverse_mass,  ///< 1/kg, 0: held
    stiffness,     ///< N/m, one row per family; the last is the factor 1 of springs with their own
    damping,       ///< N s/m: viscous, internal
    gravity,       ///< m/s^2
    wind,          ///< m/s
    air,           ///< u32: 0 means no air
    drag_row,
    drag_target,     ///< m
    drag_stiffness,  ///< N/m
    push_row,
    push_force,      ///< N
    push_remaining,  ///< s
  };
  static constexpr UserForces kHands{{push_row, push_force, push_remaining},
                                     {drag_row, drag_target, drag_stiffness}};
};

class MassSpringField final : public ForceField,
                              public LaggedDissipation,
                              public SofteningForces,
                              public StiffnessBound,
                              public PointForces {
 public:
  MassSpringField(const MassSpringDef& def, const BuildContext& context);

  State initial_state() const override;
  void acceleration(const Phase& at, std::span<double> a, Evaluation& e) const override {
    accelerate(at, a, e, Forces::all);
  }
  /// Forces (N) by which pins hold their points, 3 per point and 0 where a point is free: minus the sum of
  /// the forces of springs, gravity, air, drags and pushes on it.
  void reactions(const Phase& at, std::span<double> out, Evaluation& e) const;
  void lagged_acceleration(const Phase& at, std::span<const double> x_lagged, std::span<double> a,
                           Evaluation& e) const override;
  Dependence dependence() const override { return dependence_; }
  std::optional<double> potential(const Phase& at, Evaluation& e) const override;
  /// Viscous and internal damping, air and pushes.
  std::optional<double> dissipation(const Phase& at, Evaluation& e) const override;
  double kinetic(const Phase& at, Evaluation& e) const override;

  const LaggedDissipation* lagged_dissipation() const override { return this; }
  const SofteningForces* softening_forces() const override { return this; }
  bool has_jacobian() const override { return true; }
  bool symmetric_jacobian() const override { return true; }
  std::span<const double> inverse_mass(const State& state) const override;
  void jacobian_pattern(const State& state, BlockSparse& dfdx, BlockSparse& dfdv) const override;
  /// 1 if velocities of different points affect each other (internal damping, air on triangles), else 0.
  uint64_t pattern_version(const State& state) const override;
  void jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv, Evaluation& e) const override {
    assemble_jacobian(at, dfdx, dfdv, e, spring::stiffness, bending::hessian);
  }
  void definite_jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv,
                         Evaluation& e) const override {
    assemble_jacobian(at, dfdx, dfdv, e, spring::definite_stiffness, bending::definite_hessian);
  }
  /// omega^2 <= 2 max_i |K_ii| / m_i with the diagonal blocks of the current state: 4 k/m for a chain.
  std::optional<Stiffness> stiffness(const State& state) const override;
  /// 4 k / m of the stiffest springs and the lightest points.
  double fastest_squared(const State& state) const override;
  void soften(State& state, double share, Evaluation& e) const override;
  Lengths shift(const Phase& at, State& state, double share, Evaluation& e) const override;
  void restore(State& state, Evaluation& e) const override;
  void hold_tensions(const Phase& at, Evaluation& e) const override;
  double predict_tensions(const Phase& at, std::span<const double> u, double s, double most_turn,
                          Evaluation& e) const override;
  void release_tensions(Evaluation& e) const override;

  const StiffnessBound* stiffness_bound() const override { return this; }
  const PointForces* point_forces() const override { return this; }
  /// Bends count as at the start; air is left out.
  void bound_pattern(BlockSparse& out) const override;
  void bound(const State& state, double h, BlockSparse& out) const override;
  const PointColours& colours() const override { return colours_; }
  Vec3 free_acceleration(const State& state) const override;
  void point_slopes(const Phase& at, std::span<const double> x_lagged, double h,
                    std::span<const uint32_t> points, std::span<PointSlope> out) const override;

  const Network& network() const { return network_; }
  const SpringSchedule& schedule() const { return schedule_; }
  const std::vector<double>& masses() const { return masses_; }
  /// (l - L) / L of spring s of the schedule; l / 1 m where the rest length is zero.
  double strain(std::span<const double> x, size_t s) const;

 private:
  /// How a spring's effective stiffness follows from its squared length, constant and rest length.
  using SpringStiffness = spring::Stiffness (*)(double l2, double k, double rest);
  using BendSlope = bending::Hessian (*)(const bending::Links& links, double B);
  void assemble_jacobian(const Phase& at, BlockSparse& dfdx, BlockSparse& dfdv, Evaluation& e,
                         SpringStiffness stiffness, BendSlope slope) const;

  /// Forces from the potential, from the dissipation function, or both.
  enum class Forces : uint8_t { all, conservative, dissipative };
  void accelerate(const Phase& at, std::span<double> a, Evaluation& e, Forces which) const;
  /// Lengths without tension: the network's, or shifted ones while springs are softened.
  struct Rests {
    const double *springs, *list;
  };
  Rests rests(Evaluation& e) const;
  /// N, of every spring, for derivatives; null: those of the lengths.
  const double* held_tensions(Evaluation& e) const;
  double spring_constant(const State& state, size_t s) const;
  using Shares = std::array<double, kSpringFamilies>;
  /// Fractions of their stiffness that families keep when the stiffest keeps `share`.
  Shares softened(const double* stiffness, double share) const;
  /// Positions, velocities and forces of all points, coordinate by coordinate.
  struct Scratch {
    double *x[3], *v[3], *f[3];
    Rests rests;
  };
  Scratch scratch(Evaluation& e) const;

  /// Rows of one block.
  struct Rows {
    size_t index, begin, end;
  };
  void spring_forces(const Rows& rows, const State& state, const Scratch& s, Forces which) const;
  void bending_forces(const Rows& rows, const Scratch& s) const;
  void air_forces(const Rows& rows, const Phase& at, const Scratch& s) const;
  void hand_forces(const Rows& rows, const State& state, const Scratch& s, Forces which) const;
  void build_rows();
  void build_bends(const BlockSparse& pattern);
  void colour_points();
  void air_slope(const Phase& at, std::span<const double> x_lagged, double h, size_t i,
                 PointSlope& out) const;
  void add_bending_slopes(const Phase& at, BlockSparse& dfdx, BendSlope slope) const;
  Vec3 wind_at(const Phase& at) const;

  struct RowEntry {
    uint32_t column, spring, slot;  // spring == kNoSpring: only air couples the two points
    static constexpr uint32_t kNoSpring = UINT32_MAX;
  };

  struct PointTriangle {
    uint32_t triangle;
    std::array<uint32_t, 3> slots;  // of the blocks (point, corner)
  };

  Network network_;
  std::vector<double> masses_;
  SpringSchedule schedule_;
  std::vector<double> section_;  // m^2 per point, for the air; empty if triangles catch the wind
  Vec3 gravity_;
  double stiffness_[kSpringFamilies], damping_[2];
  double largest_scale_[kSpringFamilies] = {};  // largest scale of a family's springs
  Vec3 wind_;
  uint32_t air_ = 0;
  double air_factor_, gust_, gust_period_;
  Dependence dependence_;

  std::vector<std::array<uint32_t, 2>> pairs_;
  std::vector<uint32_t> row_begin_;  // entries of block row i: row_begin_[i] ... row_begin_[i + 1]
  std::vector<RowEntry> rows_;
  /// A bend at a point, and which of the bend's three points this is.
  struct PointBend {
    uint32_t bend, corner;
  };
  std::vector<uint32_t> point_bends_begin_;  // empty if nothing resists bending
  std::vector<PointBend> point_bends_;
  std::vector<std::array<uint32_t, 9>> bend_slots_;  // of the blocks (corner, corner)
  std::vector<uint32_t> point_triangles_begin_;
  std::vector<PointTriangle> point_triangles_;  // triangles at every point
  PointColours colours_;
};

}  // namespace truestep::mass_spring
