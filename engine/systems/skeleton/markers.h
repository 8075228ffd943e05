// Optical markers as a recorded motion: positions from a TRC file or from pictures of several cameras
// (kernels/animation/triangulation.h), to which the skeleton is fitted frame by frame, starting each from the
// one before (marker_fit.h). Joints that no visible marker determines are interpolated between neighbouring
// frames.
#pragma once
#include "engine/systems/skeleton/model.h"
#include "engine/systems/skeleton/recording.h"

namespace truestep::skeleton {

struct MarkerReport {
  double error = 0;     ///< m, root mean square distance between the markers kept and their fitted positions
  double seen = 1;      ///< share of the markers seen over all frames
  double residual = 0;  ///< pixels, root mean square reprojection error
  double outliers = 0;  ///< sightings and markers rejected
};

/// Joints are the model's. Throws Error "scene_invalid" with pointers below `where`.
Recording recording_of(const MarkersDef& def, double scale, const Model& model, const std::string& where,
                       MarkerReport& report);

}  // namespace truestep::skeleton
