// An octree over bodies (Barnes & Hut 1986) in the order of their Morton keys (Warren & Salmon 1993): a node
// is a range of that order, its up to eight children are consecutive, and so are all nodes of a depth. A node
// knows its mass M, its centre of mass c and second moments S = sum m (x - c)(x - c)^T: monopole and
// quadrupole of its field. Nodes of up to 12 bodies are leaves. Neighbours in the order, up to 64 in one
// cube, make a group, whose bodies are attracted together (Barnes 1990). Lengths are scaled by a power of two
// to a cube of half width at most 1 and masses to a sum of at most 1, so that floats hold them.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "engine/kernels/gravity/direct_sums.h"

namespace truestep::gravity {

class BodyTree {
 public:
  static constexpr size_t kMostInGroup = 64, kMostInLeaf = 12;
  static constexpr size_t kMostChildren = 8;
  static constexpr int kDepths = 21;  ///< of the keys: 63 bits

  /// Position relative to the tree's centre, and mass, both scaled.
  struct Point {
    double x = 0, y = 0, z = 0, m = 0;
  };
  /// 3 S of a node and its trace times 1.5, in the order xx, xy, xz, yy, yz, zz, trace.
  struct alignas(32) Moments {
    std::array<float, 8> s{};
  };
  /// The data that decides whether a node may stand for its bodies, as columns with eight rows more than
  /// nodes.
  struct Columns {
    std::vector<float> x, y, z;  ///< centre of mass
    std::vector<float> mass;
    std::vector<float> radius;    ///< distance of the farthest body from the centre of mass
    std::vector<float> strength;  ///< M radius^3: divided by d^5, the size of the terms omitted at distance d
  };
  struct Node {
    uint32_t begin = 0, end = 0;             ///< of the tree's order
    uint32_t first_child = 0, children = 0;  ///< none: a leaf
  };
  /// Bodies [begin, end) of the tree's order.
  struct Group {
    uint32_t begin = 0, end = 0;
  };

  /// Sorts the bodies and sums the moments. The tree depends on the bodies alone, not on the number of
  /// threads.
  void build(const Bodies& bodies, const ThreadArena& arena);

  size_t size() const { return points_.size(); }
  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Group>& groups() const { return groups_; }
  const Columns& columns() const { return columns_; }
  const Point& center(size_t node) const { return centers_[node]; }
  const Moments& moments(size_t node) const { return moments_[node]; }
  const Point& point(size_t k) const { return points_[k]; }
  /// Row of the k-th body in the tree's order.
  uint32_t row(size_t k) const { return rows_[k]; }

  /// Factor from lengths of the bodies to lengths of the tree.
  double length_scale() const { return length_scale_; }
  /// The same of G m.
  double mass_scale() const { return mass_scale_; }

 private:
  struct Keyed {
    uint64_t key;
    uint32_t row;
  };
  void set_scales(const Bodies& bodies);
  void sort(const Bodies& bodies, const ThreadArena& arena);
  void divide();
  void gather_groups(size_t node);
  void sum_moments(const ThreadArena& arena);
  void sum_bodies(size_t node);
  void sum_children(size_t node);
  void finish(size_t node);
  double farthest(size_t node) const;

  std::vector<Keyed> keyed_, sorted_;
  std::vector<Point> points_;
  std::vector<uint32_t> rows_;
  std::vector<Node> nodes_;
  std::vector<size_t> depth_ends_;  // nodes down to each depth
  std::vector<Group> groups_;
  Columns columns_;
  std::vector<Point> centers_;
  std::vector<std::array<double, 6>> seconds_;  // S in f64, for the sums upwards
  std::vector<Moments> moments_;
  std::array<double, 3> middle_{};
  double length_scale_ = 1, mass_scale_ = 1;
};

}  // namespace truestep::gravity
