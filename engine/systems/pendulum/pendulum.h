// A chain of n point masses on massless rigid rods swinging in a plane, in generalised coordinates: the
// angles theta_i of the rods from the direction of gravity. With u_i the direction of rod i and t_i
// perpendicular to it, the relative accelerations along the rods, (a_i - a_{i-1}) . u_i = -l_i theta_i'^2,
// give a tridiagonal system for the rods' tensions T,
//   (1/m_i + 1/m_{i-1}) T_i - (u_i . u_{i+1}) / m_i T_{i+1} - (u_i . u_{i-1}) / m_{i-1} T_{i-1}
//     = l_i theta_i'^2 + (f_i / m_i - f_{i-1} / m_{i-1}) . u_i,        a_0 = 0,
// after which theta_i'' = (a_i - a_{i-1}) . t_i / l_i: the exact equations of motion (those of the dense mass
// matrix m_ij = sum_{k >= max(i,j)} m_k l_i l_j cos(theta_i - theta_j)) in O(n).
#pragma once
#include <memory>
#include <vector>

#include "engine/core/commands/user_forces.h"
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/equations/force_system.h"
#include "engine/core/equations/integrator_def.h"
#include "engine/core/outputs.h"

namespace truestep::pendulum {

/// Parameters, SI. The arrays are empty or hold one value per link.
struct PendulumDef : IntegratorParams {
  int links = 1;
  double length = 1;   ///< m, of every link
  double mass = 1;     ///< kg, at the end of every link
  double angle = 0.5;  ///< rad, of every link, from the direction of gravity
  double damping = 0;  ///< N s/m, drag on every mass
  Vec3 anchor;         ///< m
  std::vector<double> lengths, masses, angles, angular_velocities;
};

/// Columns of a pendulum's state in their order.
struct PendulumColumns {
  enum Index : State::Column {
    kAngle,            ///< named position: the integrators' x, rad
    kAngularVelocity,  ///< named velocity, rad/s
    kDamping,          ///< N s/m
    kGravity,          ///< m/s^2, size
    kPushRow,          ///< mass that is pushed, from 0; one row per push
    kPushForce,        ///< N
    kPushRemaining     ///< s
  };
  static constexpr UserForces kHands{UserForces::PushColumns{kPushRow, kPushForce, kPushRemaining}};
};

class PendulumField final : public ForceField {
 public:
  PendulumField(const PendulumDef& def, const Vec3& gravity);

  State initial_state() const override;
  void acceleration(const Phase& at, std::span<double> a, Evaluation& e) const override;
  Dependence dependence() const override;
  std::optional<double> potential(const Phase& at, Evaluation& e) const override;
  double kinetic(const Phase& at, Evaluation& e) const override;
  std::optional<Stiffness> stiffness(const State& state) const override;

  size_t links() const { return length_.size(); }
  /// Points of the chain, the anchor first: (links + 1) x 3 numbers, m.
  void positions(std::span<const double> angles, double* out) const;
  /// Velocities of the same points, m/s.
  void velocities(std::span<const double> angles, std::span<const double> rates, double* out) const;
  /// Changes of the angular velocities when mass `link` (from 0) receives `impulse` (N s).
  std::vector<double> response(std::span<const double> angles, size_t link, const Vec3& impulse) const;
  /// The component of a vector in the plane of motion: along the horizontal and along gravity.
  std::array<double, 2> in_plane(const Vec3& v) const { return {dot(v, right_), dot(v, down_)}; }

 private:
  // Scratch of one evaluation, n numbers each.
  struct Arrays {
    double *sin, *cos, *fx, *fy, *diagonal, *tension;
  };
  Arrays arrays(double* memory) const;
  void solve(const Arrays& s, std::span<const double> rates, std::span<double> a) const;

  PendulumDef def_;
  std::vector<double> length_, mass_;
  double gravity_;
  Vec3 down_, right_;
};

const DefTable& pendulum_table();
/// Its outputs.
const Outputs& pendulum_outputs();
std::unique_ptr<const System> make_pendulum(const void* def, const BuildContext& context);
Cost cost_pendulum(const void* def);

}  // namespace truestep::pendulum
