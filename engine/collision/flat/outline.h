// All shapes of the plane as one type: a convex polygon of at most eight corners, thickened by a radius. One
// corner is a circle, two are a capsule, three and more run counter-clockwise. A link of a chain has two
// corners, one side (left of a to b) or both, and its neighbours' corners, so that nothing catches on the
// corner where two links meet.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/collision/flat/plane.h"
#include "engine/geometry/box.h"

namespace truestep::flat {

inline constexpr size_t kMostCorners = 8;

struct Outline {
  std::array<Vec2, kMostCorners> corner{};
  std::array<Vec2, kMostCorners> normal{};  ///< outward, of the edge from corner i to the next
  Vec2 center;                              ///< of area
  uint32_t corners = 0;
  double radius = 0;  ///< m
  /// The solid sides of a link; `all` for anything that is not a link.
  enum class Side : uint8_t { all, left, both } side = Side::all;
  /// Corners of the neighbouring links; its own ends where there is none.
  Vec2 before, after;
  enum class Neighbours : uint8_t { none = 0, before = 1, after = 2, both = 3 } neighbours = Neighbours::none;

  bool is_link() const { return side != Side::all; }
};

Outline circle(double radius, Vec2 center = {});
/// Points within `radius` of the segment a b.
Outline capsule(Vec2 a, Vec2 b, double radius);
/// Edges 2 hx and 2 hy (before rounding), turned by q about its centre.
Outline box(double hx, double hy, Vec2 center = {}, Rotation q = {}, double radius = 0);
/// Convex hull of the points, thickened by radius. Error "scene_invalid" when the hull has less than three or
/// more than eight corners.
Outline polygon(std::span<const Vec2> points, double radius = 0);
/// Links through the points, solid on the left when walking along them, or on both sides; `loop` joins the
/// last to the first. Error "scene_invalid" for fewer than two points or two equal ones in a row.
enum class Ends : uint8_t { open, loop };
std::vector<Outline> chain(std::span<const Vec2> points, Ends ends, Outline::Side side = Outline::Side::left);
/// The same link traversed in the other direction: its left is this one's right.
Outline reversed(const Outline& link);

/// The outline moved by a pose.
Outline moved(const Outline& s, const Pose& at);

/// Area (m^2), centre of area and second moment about that centre (m^4), of the rounded polygon.
struct Area {
  double area = 0;
  Vec2 center;
  double moment = 0;
};
Area area_of(const Outline& s);

/// Smallest box of the outline at a pose, flat in z.
Box bounds(const Outline& s, const Pose& at);
/// Largest distance of the outline from the point p in its own frame.
double reach(const Outline& s, Vec2 p);
/// Radius of the largest inscribed circle about the centre: how far a body may move and still overlap its
/// former position. 0 for a link.
double inner_radius(const Outline& s);

}  // namespace truestep::flat
