// Stiffness of a scene's contacts, and how their offsets follow their loads (penetration_offset.h).
#pragma once
#include <optional>

#include "engine/kernels/rigid/penetration_offset.h"
#include "engine/kernels/rigid/soft_constraint.h"

namespace truestep::rigid3d {

struct SolverSettings {
  int substeps = 5;
  double restitution_speed = 0;  ///< m/s
  double push_out_speed = 3;
  std::optional<double> contact_hertz;  ///< absent: a fixed fraction of the substeps' rate
  double contact_damping_ratio = 10;
};

/// Angular frequency of contacts as springs, rad/s, for substeps of h (s).
double contact_rate(const SolverSettings& settings, double h);

/// Coefficients of contacts for substeps of h (s).
SoftConstraint<double> contact_softness(const SolverSettings& settings, double h);

/// For steps of h (s).
PenetrationOffsetRule penetration_offset_rule(const SolverSettings& settings, double h);

}  // namespace truestep::rigid3d
