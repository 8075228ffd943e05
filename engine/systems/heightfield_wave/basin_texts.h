// The expressions of a shallow-water scene: the bed, the initial surface and velocity, and the exact surface
// if known.
#pragma once
#include "engine/math/expression/rows.h"
#include "engine/systems/heightfield_wave/heightfield_wave_def.h"

namespace truestep::heightfield_wave {

struct BasinTexts {
  /// Error "scene_invalid" with every fault.
  explicit BasinTexts(const HeightfieldWaveDef& def);

  ExpressionRows bed, surface, exact;
  std::array<ExpressionRows, 2> velocity;
  bool has_exact = false;

  /// out = the expression at the cell centres, x running fastest.
  static void sample(const ExpressionRows& text, const shallow::Basin& basin, double t, double* out);
};

}  // namespace truestep::heightfield_wave
