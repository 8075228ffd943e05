// A vector that a scene gives as expressions of place and time: velocity, acceleration, position.
#pragma once
#include <string>
#include <vector>

#include "engine/math/expression/rows.h"
#include "engine/math/vec3.h"

namespace truestep {

/// Up to three expressions of t, x, y and z (no z in the plane).
class PlaceTexts {
 public:
  static constexpr size_t kMost = ExpressionRows::kBlock;

  PlaceTexts() = default;
  /// Error "scene_invalid" with `pointer` and an index after it if a text is invalid. Empty texts: nothing.
  PlaceTexts(const std::vector<std::string>& texts, int dimension, const std::string& pointer);

  bool empty() const { return components_ == 0; }
  size_t instructions() const { return program_.instructions(); }
  /// All components at `count` (at most kMost) points, `stride` apart.
  void run(double t, const double* x, const double* y, const double* z, size_t count, double* out,
           size_t stride) const;

 private:
  ExpressionRows program_;  ///< a single program, so that common subexpressions are computed once
  size_t components_ = 0;
};

}  // namespace truestep
