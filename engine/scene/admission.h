// Estimates what a scene will cost, from counts alone and before anything is allocated, and whether that is
// allowed.
#pragma once
#include "engine/base/errors.h"
#include "engine/core/def/build.h"
#include "engine/scene/scene.h"

namespace truestep {

struct AdmissionLimits {
  double memory_bytes = 2e9;  ///< state + workspace of one session
  double elements = 2e7;
  double seconds_per_step = 60;
  double start_seconds = 120;  ///< before the first step
};

/// For one's own machine, on the command line.
inline constexpr AdmissionLimits kOwnMachine{
    .memory_bytes = 16e9, .elements = 1e9, .seconds_per_step = 1e6, .start_seconds = 1e9};

/// Sum over the scene's systems and couplings, substeps included.
Cost estimate(const Scene& scene);

/// Error "too_large" with the estimate and the limit of everything that exceeds its limit.
void require_admission(const Cost& cost, const AdmissionLimits& limits);

}  // namespace truestep
