// A surface that is a weighted sum of shapes, for file writers: its base, its targets and their weights in a
// state (Ports::morph).
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/core/system.h"
#include "engine/geometry/shape.h"
#include "engine/kernels/animation/blend.h"

namespace truestep {

class Morphed {
 public:
  struct Port {
    std::span<const Vec3> base;  ///< m
    std::span<const std::array<uint32_t, 3>> triangles;
    std::span<const std::string> names;  ///< of targets
    std::span<const animation::ShapeOffsets> targets;
  };
  virtual ~Morphed() = default;
  virtual Port morph() const = 0;
  /// Weights of the targets, and the pose of the whole, at t (s).
  virtual Pose morph_at(const State& state, double t, std::span<double> weights) const = 0;
};

}  // namespace truestep
