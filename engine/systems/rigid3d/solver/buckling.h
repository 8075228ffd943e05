// Number of substeps that columns of stacked bodies need. Contacts resist tilting like springs whose rate w
// is limited by the substeps (contact_softness.h), and a column above some length buckles under its own
// weight (Greenhill 1881). With the trial shape theta(z) = s (2 - s), s = z / height, for the tilts of an
// island
//   Q = sum over bodies of k (theta - theta of what bears it)^2 / sum over bodies of m g integral_0^z theta^2
// is the Rayleigh quotient of stiffness and load: below 1 it buckles. k is the smaller stiffness against
// tilts of the points that bear a body, w^2 sum_p m_p d_p d_p^T about their middle, m_p the mass that a push
// at a point meets; it and Q grow with the square of the substeps. Uniform columns get 8.0; the exact number
// is 7.84. Only islands whose loaded contacts are all patches count; the stability of others depends on their
// shape.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "engine/core/system.h"
#include "engine/systems/rigid3d/contacts.h"
#include "engine/systems/rigid3d/rigid3d_state.h"
#include "engine/systems/rigid3d/solver/contact_softness.h"

namespace truestep::rigid3d {

/// Chooses the substeps of a step from the contacts of the last one.
class BucklingWatch {
 public:
  static constexpr int kMostTimes = 6;
  /// At least settings.substeps, at most kMostTimes as many; `now` is what the last step took.
  int substeps(const State& s, std::span<const BodyKind> kinds, std::span<Contact* const> contacts,
               const SolverSettings& settings, int now, double h);

 private:
  struct Island {
    double low = 0, high = 0, stiffness = 0, load = 0;
    bool counts = true;
  };
  /// What bears a body: sums over points, each weighted by its mass m_p.
  struct Support {
    double mass = 0, tilt = 0;
    Vec3 place, squares, products;  ///< of the arms across gravity: x, x^2, yz and so on
    /// kg m^2, the smaller one about the middle of the points.
    double least() const;
  };
  std::vector<uint32_t> parent_;
  std::vector<Island> island_;
  std::vector<Support> support_;
  std::vector<std::array<double, Manifold::kMost>> inverse_mass_;  ///< 1/kg, of every contact's points
};

}  // namespace truestep::rigid3d
