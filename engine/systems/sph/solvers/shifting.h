// Particle shifting: after a substep particles move a little from where they are dense to where they are
// sparse, so that a flow does not gather them along its streamlines,
//   dx = -A u h H grad C,  grad C_i = sum_j V (1 + R (W_ij / W(s))^4) grad W_ij,
// u the fastest particle's speed, h the substep, H the kernel's radius, s the spacing (Skillen, Lind, Stansby
// & Rogers 2013; u and the term with R = 0.2 as by Sun, Colagrossi, Marrone & Zhang 2017, who have A = 2).
// What the flow has at the new place follows from its gradient (Lind, Xu, Stansby & Rogers 2012, equation
// 33). A u h H is limited such that rows do not overshoot. Near a free surface grad C points out of the
// liquid, so that particles stay.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/systems/sph/fluid.h"

namespace truestep::sph {

template <int D, class T>
class Shifting {
 public:
  explicit Shifting(const Setting& set)
      : set_(set),
        per_near_(
            static_cast<T>(1 / (set.kernel_w * smoothing_at(set.def.kernel, 1 / set.def.support).w[0]))) {
    if (any()) widest_ = kStable / stiffest();
  }

  bool any() const { return set_.shifting > 0; }

  /// Whether a particle has neighbours all around it: 0 to 1, from the kernel's sum over particles and walls.
  static T inside(T sum) { return std::clamp((sum - T(0.9)) / T(0.08), T{0}, T{1}); }

  /// Leaves displacements in f.shift (m, four a row), and changes velocities and, if `carried`, densities to
  /// those there; `way` (m) is that of the fastest particle in the substep.
  void shift(Fluid<D, T>& f, double way, bool carried, const ThreadArena& arena) const;

 private:
  using W = Wide<T>;
  /// 1/m^2, the largest factor of grad C on a displacement: of rows of a lattice of which every other one is
  /// displaced, along an axis or along all of them, across themselves.
  double stiffest() const;

  static constexpr T kNear = T(0.2);
  /// Largest part of a displacement that is undone at once; at 2 it only changes sides.
  static constexpr double kStable = 1;
  static constexpr double kMost = 0.2;  ///< spacings in a substep

  const Setting& set_;
  T per_near_;
  double widest_ = 0;  ///< m^2, the largest A u h H
};

}  // namespace truestep::sph
