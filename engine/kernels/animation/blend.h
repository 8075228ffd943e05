// Blend shapes: x = b + sum_k w_k d_k, linear in the weights; d_k = target_k - b is stored only where it is
// not zero. A corrective shape has the product of other shapes' weights as its own: it repairs what two
// shapes spoil together.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep::animation {

struct ShapeOffsets {
  std::vector<uint32_t> rows;
  std::vector<Vec3> offsets;  ///< m
};

/// out += weight * offsets, n x 3.
inline void add_shape(const ShapeOffsets& shape, double weight, double* out) {
  if (weight == 0) return;
  for (size_t k = 0; k < shape.rows.size(); ++k) {
    double* x = out + 3 * size_t{shape.rows[k]};
    x[0] += weight * shape.offsets[k].x, x[1] += weight * shape.offsets[k].y,
        x[2] += weight * shape.offsets[k].z;
  }
}

}  // namespace truestep::animation
