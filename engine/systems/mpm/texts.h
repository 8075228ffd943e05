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

  bool empty() const { return programs_.empty(); }
  /// Component c at `count` (at most kMost) places.
  void run(size_t c, double t, const double* x, const double* y, const double* z, size_t count,
           double* out) const;

 private:
  std::vector<ExpressionRows> programs_;
};

}  // namespace truestep::mpm
