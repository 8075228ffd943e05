// Number of substeps that columns of stacked bodies need. Contacts resist tilting like springs whose rate w
// is limited by the substeps (contact_softness.h), and a column above some length buckles under its own
// weight (Greenhill 1881). With the trial shape theta(z) = s (2 - s), s = z / height, for the tilts of an
// island
//   Q = sum over contacts of k (theta_b - theta_a)^2 / sum over bodies of m g integral_0^z theta^2
// is the Rayleigh quotient of stiffness and load: below 1 it buckles. k = 1.5 w^2 / (1/I_a + 1/I_b): Q grows
// with the square of the substeps. Uniform columns get 8.0; the exact number is 7.84. Only islands whose
// loaded contacts are all patches count; the stability of others depends on their shape.
#pragma once
#include <vector>

#include "engine/core/system.h"
#include "engine/systems/rigid3d/rigid3d_state.h"
#include "engine/systems/rigid3d/solver/contact_softness.h"

namespace truestep::rigid3d {

/// Chooses the substeps of a step from the loads of the last one.
class BucklingWatch {
 public:
  static constexpr int kMostTimes = 6;
  /// At least settings.substeps, at most kMostTimes as many; `now` is what the last step took.
  int substeps(const State& s, std::span<const BodyKind> kinds, const SolverSettings& settings, int now,
               double h);

 private:
  struct Island {
    double low = 0, high = 0, stiffness = 0, load = 0;
    bool counts = true;
  };
  std::vector<uint32_t> parent_;
  std::vector<Island> island_;
};

}  // namespace truestep::rigid3d
