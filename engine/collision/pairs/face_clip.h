// From two faces to contact points: the incident face is cut by the side planes of the reference face
// (Sutherland, Hodgman 1974), corners within the margin of the reference plane become points, and the best
// four of them are kept.
#pragma once
#include <span>

#include "engine/collision/pairs/manifold.h"

namespace truestep {

/// A flat face, an edge (2 corners) or a corner, with ids that identify its corners.
struct FacePolygon {
  static constexpr int kMost = 48;
  int count = 0;
  Vec3 corner[kMost];
  uint32_t id[kMost];

  /// Ignored when full.
  void add(const Vec3& p, uint32_t corner_id) {
    if (count < kMost) corner[count] = p, id[count] = corner_id, ++count;
  }
  /// Keeps the part on the inner side: outward . p <= offset. New corners are named after their edge's first
  /// corner and `plane`.
  void cut(const Vec3& outward, double offset, uint32_t plane);
};

/// Points of `incident` inside the prism over `reference` (3 corners or more, anticlockwise seen against the
/// unit normal) and no further than `margin` above its plane, as a manifold with the normal +-`normal`:
/// `flip` < 0 when the reference is the second body's. Ids hold `tag` in the upper 16 bits.
enum class FaceOwner : uint8_t { first, second };
void clip_faces(const FacePolygon& reference, const Vec3& normal, FacePolygon incident, double margin,
                FaceOwner owner, uint32_t tag, Manifold& out);

/// The same for a segment or a corner that touches along `along` (unit), a slanted prism over the reference:
/// separations and the manifold's normal are along it, from the first body's face to the second.
void clip_slanted(const FacePolygon& reference, const Vec3& normal, const Vec3& along, FacePolygon incident,
                  double margin, uint32_t tag, Manifold& out);

/// Keeps at most four of the points: the outermost along two directions and the deepest. `normal` is unit.
struct PointList {
  static constexpr int kMost = FacePolygon::kMost;
  int count = 0;
  ContactPoint point[kMost];

  std::span<const ContactPoint> all() const { return {point, static_cast<size_t>(count)}; }
};
void keep_best(std::span<const ContactPoint> all, const Vec3& normal, Manifold& out);

}  // namespace truestep
