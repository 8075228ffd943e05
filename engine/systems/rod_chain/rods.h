// The equations of a chain of thin rods: its constraints, their matrix and the effect of forces. Arrays with
// one entry per rod; joint j is at the start of rod j.
#pragma once
#include <span>
#include <vector>

#include "engine/kernels/block_tridiagonal.h"
#include "engine/kernels/rigid/free_rotation.h"

namespace truestep::rod_chain {

struct Rod {
  Vec3 x, u;  ///< m; unit, towards the rod's end
  Vec3 v, w;  ///< m/s; rad/s, across u
};

/// A push, or a drag: a damped spring from a point of a rod to a point in space.
struct Hand {
  size_t rod = 0;
  double along = 0;                   ///< m, from the rod's centre towards its end
  Vec3 force;                         ///< N
  double stiffness = 0, damping = 0;  ///< N/m, N s/m
  Vec3 target;                        ///< m
};

struct Chain {
  double half = 0.1, mass = 0.1, inertia = 0;  ///< m, kg, kg m^2 across
  Vec3 anchor, gravity;
  std::span<const Hand> hands;
};

/// x turned by the rotation vector r.
inline Vec3 turned(const Vec3& x, const Vec3& r) {
  return rotation(free_rotation::turn(r)).apply(x);
}

/// C_j (m).
void gaps(const Chain& c, std::span<const Rod> rods, std::span<Vec3> out);
/// C_j' (m/s).
void gap_rates(const Chain& c, std::span<const Rod> rods, std::span<Vec3> out);
/// J M^-1 J^T (1/kg) for these positions, factorised.
void constraint_matrix(const Chain& c, std::span<const Rod> rods, BlockTridiagonal& a);
/// An upper bound of its largest eigenvalue (1/kg) for any positions.
double largest_eigenvalue(const Chain& c);
/// M^-1 J^T F of rod j: changes of v and w per unit of time (or of x and u, where F is an impulse per mass).
struct Change {
  Vec3 v, w;
};
Change response(const Chain& c, std::span<const Rod> rods, std::span<const Vec3> force, size_t j);
/// Effect of a force (or impulse) on a rod, `along` m from its centre.
Change pulled(const Chain& c, const Rod& rod, double along, const Vec3& force);
/// Accelerations of a hand's rod by its present force.
Change hand_rates(const Chain& c, const Rod& rod, const Hand& hand);
/// Changes of v and w in a step of h (s); stable for any stiffness.
Change hand_step(const Chain& c, const Rod& rod, const Hand& hand, double h);
/// Energies (J).
double kinetic(const Chain& c, std::span<const Rod> rods);
double potential(const Chain& c, std::span<const Rod> rods);
/// Of joints that are springs with stiffness k (N/m).
double stored(const Chain& c, std::span<const Rod> rods, double k);
double largest_gap(const Chain& c, std::span<const Rod> rods);

}  // namespace truestep::rod_chain
