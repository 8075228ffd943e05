// Triangle surface with a tree and the neighbour data that contacts need. A triangle is solid on the side
// from which its corners run clockwise; bodies are pushed out on the other side, its front. Inside a surface,
// a contact's normal may not lean over an edge further than the neighbour across it allows (ghost contacts):
// the directions allowed at an edge are
//   { d : d . m_own <= 0 and d . m_neighbour <= 0 },   m: in a triangle's plane, from the edge into it,
// which for flat and concave edges leaves only the triangle's normal.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/geometry/static_tree.h"

namespace truestep {

/// One triangle, ready for contact.
struct MeshTriangle {
  static constexpr uint32_t kBorder = 0xffffffff;
  std::array<Vec3, 3> corner;
  std::array<uint32_t, 3> vertex{};  ///< of a mesh: the corners' numbers
  Vec3 normal;                       ///< unit, to the front
  std::array<Vec3, 3> inward;        ///< per edge k -> k + 1: unit, into this triangle
  std::array<Vec3, 3> beyond;        ///< unit, into the neighbour; zero at a border
  std::array<uint32_t, 3> neighbor{kBorder, kBorder, kBorder};

  /// Fills normal and inward from the corners. False for a triangle without area.
  bool complete();
  /// Sets the neighbour across edge k: a triangle whose third corner is `third`.
  void set_neighbor(size_t k, uint32_t index, const Vec3& third);
  /// True when a body may be pushed along the unit vector d by this triangle.
  bool allows(const Vec3& d) const;
};

class TriangleMesh {
 public:
  /// Triples of vertex indices. Triangles without area are dropped. Error "bad_solid" for an index out of
  /// range, a number that is not finite, or when nothing is left.
  TriangleMesh(std::vector<Vec3> vertices, std::vector<uint32_t> triangles);

  size_t size() const { return triangles_.size(); }
  const MeshTriangle& triangle(uint32_t i) const { return triangles_[i]; }
  const StaticTree& tree() const { return tree_; }
  /// True when every edge has exactly one neighbour: the surface encloses a volume.
  bool closed() const;

 private:
  std::vector<MeshTriangle> triangles_;
  StaticTree tree_;
};

}  // namespace truestep
