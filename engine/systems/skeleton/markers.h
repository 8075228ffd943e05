// Optical markers as a recorded motion: their places, from a TRC file or from pictures of several cameras
// (kernels/animation/triangulation.h), to which the skeleton is fitted frame by frame, each from the one
// before (marker_fit.h). What no marker that was seen tells anything about is taken from the frames before
// and after.
#pragma once
#include "engine/systems/skeleton/model.h"
#include "engine/systems/skeleton/recording.h"

namespace truestep::skeleton {

struct MarkerReport {
  double error =
      0;  ///< m, root of the mean square distance of all markers that count from where the fit has them
  double seen = 1;      ///< share of all markers and frames
  double residual = 0;  ///< pixels, root of the mean square of what is left in the pictures
  double outliers = 0;  ///< sightings and markers set aside
};

/// Joints are those of the model. Throws Error "scene_invalid" with pointers below `where`.
Recording recording_of(const MarkersDef& def, double scale, const Model& model, const std::string& where,
                       MarkerReport& report);

}  // namespace truestep::skeleton
