// How much of a kernel lies inside a solid, relative to a half space at the same distance: 1 next to a flat
// face, less at edges, corners and round surfaces. A map of the solid's surroundings in its own frame, made
// once (compare the volume maps of Bender et al. 2019); what a half space adds is in
// kernels/sph/half_space.h.
#pragma once
#include <array>
#include <vector>

#include "engine/collision/point_distance.h"
#include "engine/geometry/solid.h"
#include "engine/systems/sph/setting.h"

namespace truestep::sph {

class VolumeMap {
 public:
  VolumeMap(const Solid& solid, const Setting& setting);

  struct At {
    double share;  ///< 1
    Vec3 slope;    ///< 1, of the share's gradient into the solid: at a flat face its inward unit normal
  };
  /// At a point in the solid's frame; `normal` is the outward normal of the nearest surface.
  At at(const Vec3& p, const Vec3& normal) const;
  /// How to query distances from the solid.
  MeshSides sides() const { return sides_; }

 private:
  /// Share and slope factors of a node.
  using Node = std::array<float, 4>;
  size_t index(const std::array<int, 3>& n) const {
    return (static_cast<size_t>(n[2]) * static_cast<size_t>(count_[1]) + static_cast<size_t>(n[1])) *
               static_cast<size_t>(count_[0]) +
           static_cast<size_t>(n[0]);
  }
  bool lay(const Solid& solid, const Setting& setting);
  Vec3 place(const std::array<int, 3>& n) const {
    return low_ + Vec3{n[0] * width_, n[1] * width_, n[2] * width_};
  }

  MeshSides sides_ = MeshSides::front;
  Vec3 low_;
  double width_ = 0;  ///< m, between nodes
  std::array<int, 3> count_{};
  std::vector<Node> nodes_;  ///< empty: flat everywhere
};

}  // namespace truestep::sph
