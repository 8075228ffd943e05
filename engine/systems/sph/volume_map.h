// How much of a kernel lies inside a solid, relative to a half space at the same distance: 1 next to a flat
// face, less at edges, corners and round surfaces, more inside a corner of a container. A map of the solid's
// surroundings in its own frame, made once (compare the volume maps of Bender et al. 2019); what a half space
// adds is in kernels/sph/half_space.h.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "engine/collision/point_distance.h"
#include "engine/geometry/mass_properties.h"
#include "engine/geometry/shape.h"
#include "engine/geometry/solid.h"
#include "engine/kernels/sph/smoothing.h"

namespace truestep::sph {

class VolumeMap {
 public:
  /// The kernel that a map is made for: its radius and the spacing of particles, in m.
  struct Kernel {
    Smoothing kind = Smoothing::cubic;
    double support = 0, spacing = 0;
  };
  /// The surroundings of a body.
  VolumeMap(const Solid& solid, const Kernel& kernel);
  /// The surroundings, within `region`, of a mesh that encloses a volume: the wall is in that volume
  /// (`inside`: outside of it).
  VolumeMap(const Solid& mesh, const Kernel& kernel, const Box& region, PointSide side);

  /// Nodes of the coarsest map of a region; a map of more than kMostNodes cannot be made.
  static double least_nodes(const Box& region, const Kernel& kernel);
  static constexpr double kMostNodes = 8e6;

  struct At {
    double share;  ///< 1
    Vec3 slope;    ///< 1, of the share's gradient into the solid: at a flat face its inward unit normal
  };
  /// At a point in the solid's frame; `normal` is the outward normal of the nearest surface.
  At at(const Vec3& p, const Vec3& normal) const;
  /// m, of a wall: integral over it of the kernel's gradient times the offset, less the share, in the unit of
  /// `slope`: at a flat face the distance times n n^T. Times gravity it is the term that the solves leave out
  /// (walls.h).
  Symmetric3 lean_at(const Vec3& p) const;
  /// m, of a wall: bounds on the distance of p, negative behind it; empty beyond the kernel's reach.
  struct Bounds {
    double least, most;
  };
  std::optional<Bounds> distance_at(const Vec3& p) const;
  /// How to query distances from the solid.
  MeshSides sides() const { return sides_; }

 private:
  /// Share and slope factors of a node.
  using Node = std::array<float, 4>;
  using Count = std::array<int, 3>;
  struct Corners {
    std::array<uint32_t, 8> slot;
    std::array<double, 8> weight;
  };
  size_t index(const Count& n) const {
    return (static_cast<size_t>(n[2]) * static_cast<size_t>(count_[1]) + static_cast<size_t>(n[1])) *
               static_cast<size_t>(count_[0]) +
           static_cast<size_t>(n[0]);
  }
  bool lay(const Box& region, const Kernel& kernel, double most);
  void fill(const Solid& solid, const Kernel& kernel, PointSide side, bool wall);
  Corners around(const Vec3& p) const;
  Vec3 place(const Count& n) const { return low_ + Vec3{n[0] * width_, n[1] * width_, n[2] * width_}; }

  MeshSides sides_ = MeshSides::front;
  Vec3 low_;
  double width_ = 0;  ///< m, between nodes
  Count count_{};
  std::vector<uint32_t> slot_;               ///< of each node among the following; 0: far from the surface
  std::vector<Node> nodes_;                  ///< empty: flat everywhere
  std::vector<std::array<float, 6>> leans_;  ///< of a wall: xx yy zz xy xz yz, m
  std::vector<float> distances_;             ///< of a wall, m
};

}  // namespace truestep::sph
