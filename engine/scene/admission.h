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
};

/// Sum over the scene's systems and couplings, substeps included.
Cost estimate(const Scene& scene);

/// Error "too_large" with the estimate and the limit of everything that exceeds its limit.
void require_admission(const Cost& cost, const AdmissionLimits& limits);

}  // namespace truestep
