// The contact potential kappa sum b(gap) and the lagged friction potential, with gradients and positive
// semidefinite Hessians: for the barrier the curvature along the gap (the omitted term, from the change of
// the gap's direction, is negative), for friction the full one.
#pragma once
#include <vector>

#include "engine/kernels/contact/barrier.h"
#include "engine/systems/fem/barrier/barrier_surface.h"

namespace truestep::fem {

struct BarrierLaw {
  double reach = 0;      ///< m, gap below which features push
  double stiffness = 0;  ///< N/m, kappa
  double still = 0;      ///< m of slip in a step, below which friction grows with it
};

/// Where the features are evaluated: `x` holds nodes and corners; walls as they are at time t.
struct BarrierPlace {
  std::span<const double> x;
  double t;
};

/// A quadratic form of up to four rows, (sum c_i dx_i)^T m (sum c_i dx_i).
struct BarrierHessian {
  std::array<uint32_t, 4> rows{};
  std::array<double, 4> c{};
  uint32_t count = 0;
  Mat3 m;
};

struct FrictionTerm {
  std::array<uint32_t, 4> rows{};
  std::array<double, 4> c{};
  uint32_t count = 0;
  Vec3 normal, shift;  ///< unit; m, motion of the wall
  double most = 0;     ///< N, coefficient times normal force
};

/// A pair within reach, as the quadratic model sees it.
struct BarrierTouch {
  const FeaturePair* pair;
  Proximity near;
  double gap, curvature;  ///< m; N/m, of the potential along the gap
};

/// Contributions of features within reach. Gradients go to `gradient` (3 a row, nodes only), forms to
/// `forms`; both may be left out.
struct BarrierOutput {
  std::span<double> gradient{};
  std::vector<BarrierHessian>* forms = nullptr;
  std::vector<BarrierTouch>* touches = nullptr;
  /// Form of friction along a slip: the exact second derivative, or one whose model bounds the potential from
  /// above: steps then never overshoot where slips reverse, but converge slowly.
  enum class Slip : uint8_t { exact, above } slip = Slip::exact;
  double least_gap = HUGE_VAL;
  size_t touching = 0;  ///< pairs within reach
};

/// J. Infinite if anything touches.
double barrier_energy(const BarrierSurface& surface, const BarrierLaw& law, const BarrierPlace& at,
                      std::span<const FeaturePair> pairs, BarrierOutput& out);

/// Updates the lagged friction: normals and normal forces of all pairs within reach; slip is measured from
/// here.
void look_at_friction(const BarrierSurface& surface, const BarrierLaw& law, const BarrierPlace& at,
                      double start, std::span<const FeaturePair> pairs, std::vector<FrictionTerm>& out);

/// J, of slips from x0 to x.
double friction_energy(const BarrierLaw& law, std::span<const FrictionTerm> terms, std::span<const double> x0,
                       std::span<const double> x, size_t nodes, BarrierOutput& out);

}  // namespace truestep::fem
