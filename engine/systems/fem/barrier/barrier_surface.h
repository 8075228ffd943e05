// The features that must not touch: the surface of a body, as triangles, edges and points, and the obstacles
// around it. Solid obstacles are features too, whose corners follow their prescribed motion: a box is its
// triangles, a ball a point with a radius, a capsule an edge with one. Half spaces and the insides of
// containers are convex, so the body's nodes alone determine its distance to them: these are walls.
#pragma once
#include <optional>
#include <string>

#include "engine/collision/points/collider_set.h"
#include "engine/kernels/contact/proximity.h"
#include "engine/systems/fem/body.h"

namespace truestep::fem {

/// Two features that may meet: a point and a triangle, or two edges.
struct FeaturePair {
  std::array<uint32_t, 4> rows;  ///< nodes, then corners of obstacles
  bool edges = false;
  float radius = 0;     ///< m, sum of both
  float friction = 0;   ///< Coulomb's coefficient
  double parallel = 0;  ///< m^4, threshold of the mollifier for two edges

  FeaturePoints at(std::span<const double> x) const {
    return {load3(x.data(), rows[0]), load3(x.data(), rows[1]), load3(x.data(), rows[2]),
            load3(x.data(), rows[3])};
  }
  Proximity closest(const FeaturePoints& x) const {
    return edges ? SegmentSegment::closest(x) : PointTriangle::closest(x);
  }
};

/// A side of an obstacle that nodes must stay on.
struct Wall {
  uint32_t collider;
  int8_t face = -1;  ///< of a box from inside: 0 to 5
};
struct WallGap {
  double gap;
  Vec3 normal;
};

class BarrierSurface {
 public:
  BarrierSurface(const Body& body, const ColliderSet& colliders, std::span<const Surface> surfaces,
                 double own_friction);

  size_t nodes() const { return nodes_; }
  /// Nodes and corners of obstacles.
  size_t rows() const { return nodes_ + corners_.size(); }
  /// Ascending.
  const std::vector<uint32_t>& surface_nodes() const { return points_; }
  /// m, of the body's own edges.
  double shortest_edge() const { return shortest_; }

  /// Writes the corners of obstacles at time t, after the nodes.
  void place_obstacles(double t, std::span<double> x) const;
  /// Pairs that come within `reach` (m) of each other on their paths from x to x + d; empty d: at x.
  void find_pairs(std::span<const double> x, std::span<const double> d, double reach,
                  std::vector<FeaturePair>& out) const;

  const std::vector<Wall>& walls() const { return walls_; }
  WallGap wall_gap(const Wall& wall, double t, const Vec3& x) const;
  double wall_friction(const Wall& wall) const { return frictions_[wall.collider]; }
  /// m, displacement of the wall's material at x from time t0 to t.
  Vec3 wall_shift(const Wall& wall, double t0, double t, const Vec3& x) const;

  /// Describes what touches or intersects at time t; nothing if all features are apart.
  std::optional<std::string> entangled(std::span<const double> nodes, double t) const;

 private:
  struct Corner {
    uint32_t collider;
    Vec3 at;  // m, in the obstacle's frame
  };
  struct Edge {
    std::array<uint32_t, 2> rows;
    double length2;
    float radius, friction;
  };
  struct Triangle {
    std::array<uint32_t, 3> rows;
    float friction;
  };
  struct Point {
    uint32_t row;
    float radius, friction;
  };
  void add_obstacle(const Collider& c, uint32_t index);
  bool of_body(uint32_t row) const { return row < nodes_; }
  double pair_friction(uint32_t a, float of_a, uint32_t b, float of_b) const;

  size_t nodes_;
  double own_friction_, shortest_ = HUGE_VAL;
  const ColliderSet& colliders_;
  std::vector<double> frictions_;  // per collider
  std::vector<uint32_t> points_;
  std::vector<Point> all_points_;
  std::vector<Edge> edges_;
  std::vector<Triangle> triangles_;
  std::vector<Corner> corners_;
  std::vector<Wall> walls_;
};

}  // namespace truestep::fem
