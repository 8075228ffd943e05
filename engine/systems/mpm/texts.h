// Texts of a scene as numbers: an acceleration by place and time, and places that are known at any time.
#pragma once
#include <string>
#include <vector>

#include "engine/math/expression/rows.h"
#include "engine/math/vec3.h"

namespace truestep::mpm {

/// Up to three expressions of t, x, y and z (no z in the plane).
class Texts {
 public:
  static constexpr size_t kMost = ExpressionRows::kBlock;

  Texts() = default;
  /// Error "scene_invalid" with `pointer` and a number behind it where a text is none. Empty texts: nothing.
  Texts(const std::vector<std::string>& texts, int dimension, const std::string& pointer);

  bool empty() const { return components_ == 0; }
  size_t instructions() const { return program_.instructions(); }
  /// All components at `count` (at most kMost) places, `stride` apart.
  void run(double t, const double* x, const double* y, const double* z, size_t count, double* out,
           size_t stride) const;

 private:
  ExpressionRows program_;  ///< one, so that what components share is computed once
  size_t components_ = 0;
};

}  // namespace truestep::mpm
