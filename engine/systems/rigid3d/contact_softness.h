// How contacts give way, and how they take it back. A contact is a damped spring of the bodies' reduced mass
// m (soft_constraint.h), which a load presses in by load / (m w^2): stacks would sink. So the surfaces have a
// pad between them that grows by a share of the depth in every step, until under that load they just touch:
// an integral term beside the spring, far slower than what the contact carries moves. It is the same for all
// points of a contact, because a tower whose contacts learnt to tilt would lean.
#pragma once
#include <optional>

#include "engine/kernels/soft_constraint.h"

namespace truestep {

struct SolverSettings {
  int substeps = 5;
  double rest_speed = 0.05, push_out_speed = 3;
  std::optional<double> contact_hertz;  ///< absent: a fixed share of the substeps' rate
  double contact_damping = 10;
};

/// How the pads of contacts follow their loads.
struct ContactPadding {
  double learnt;    ///< share of the depth taken back in a step
  double per_load;  ///< s, times the load: the thickest pad
};

/// Coefficients of contacts for substeps of h (s).
SoftConstraint<double> contact_softness(const SolverSettings& settings, double h);

/// For steps of h (s).
ContactPadding contact_padding(const SolverSettings& settings, double h);

/// The pad of a contact that was `depth` (m) deep under its load: impulse of a substep times 1/m_a + 1/m_b
/// (m/s).
double next_pad(double pad, double depth, double load, const ContactPadding& padding);

}  // namespace truestep
