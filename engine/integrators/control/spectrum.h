// The fastest motion of a force field, by power iteration (von Mises 1929) on the scene's own linearisation:
// the largest eigenvalue of -da/dx (omega^2) and of -da/dv (damping rate). Products with the derivatives are
// central differences of the acceleration, so no matrix is needed.
#pragma once
#include "engine/core/equations/force_field.h"

namespace truestep {

struct Spectrum {
  double omega = 0;     ///< 1/s, largest angular frequency of the undamped linearisation
  double damping = 0;   ///< 1/s, largest rate of -da/dv
  int iterations = 0;   ///< of both together
  double residual = 0;  ///< relative |A u - lambda u| for the frequency's vector: how far from converged
};

/// When an iteration stops: after this many products, or when an eigenvalue changes by less.
struct SpectrumEffort {
  int most_iterations = 2000;
  double settled = 1e-7;  ///< relative
};
/// Enough for choosing a method: a few percent.
inline constexpr SpectrumEffort kRoughSpectrum{.most_iterations = 60, .settled = 1e-3};

/// At `state`, time t in s. Positions move along G(x) u where they have coordinates of their own.
Spectrum estimate_spectrum(const ForceField& field, const State& state, double t,
                           const SpectrumEffort& effort = {});

}  // namespace truestep
