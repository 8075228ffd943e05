// Which points touch which bodies during a substep, and which places on bodies (corners, centres of balls)
// touch the triangles and capsules between the points. Slow pairs are tested at the end of the substep; a
// point that moves more than half a body's thickness is tested by conservative advancement
// (collision/queries/time_of_impact.h), and the places on bodies along their straight paths
// (kernels/contact/point_hull.h), so that nothing is passed within a substep; edges against edges in their
// positions at the substep's start and end (edge_touch.h). The result's order depends only on the rows. Not
// covered: meshes and height fields against the inside of triangles.
#pragma once
#include <vector>

#include "engine/collision/broad/box_grid.h"
#include "engine/collision/queries/sweep.h"
#include "engine/couplings/contact/contact_search.h"
#include "engine/couplings/contact/touch_form.h"
#include "engine/couplings/points_on_bodies.h"
#include "engine/geometry/solid.h"

namespace truestep::contact {

/// Poses and velocities of all bodies at the substep's start, and their velocities after the systems' own
/// step.
class BodyMemory {
 public:
  void store(const ConstBodies& start);
  void follow(const ConstBodies& end);
  const Pose& pose(size_t row) const { return poses_[row]; }
  const Vec3& velocity(size_t row) const { return start_[row].v; }
  const Vec3& spin(size_t row) const { return start_[row].w; }
  /// m/s^2 at `arm`, averaged over the substep.
  Vec3 acceleration(size_t row, const Vec3& arm, double h) const {
    const Twist a = start_[row], b = free_[row];
    return (b.v + cross(b.w, arm) - a.v - cross(a.w, arm)) / h;
  }

 private:
  struct Twist {
    Vec3 v, w;
  };
  std::vector<Pose> poses_;
  std::vector<Twist> start_, free_;
};

/// Two points joined by a straight line.
using PointEdge = std::array<uint32_t, 2>;
/// Every edge of the hulls, once, in place of what is in `out`.
void find_edges(const PublishedSolids& hulls, std::vector<PointEdge>& out);

/// A blend of points that meets a body in a plane: n from the body to the points, `place` on the body in that
/// plane.
struct BodyTouch {
  BodyLink link;
  Vec3 n, place;     ///< world, unit; m, in the body's frame
  Vec3 from;         ///< m, in the body's frame: where the points first touched
  double reach = 0;  ///< m, distance from the plane at which they touch
  double s = 0;      ///< fraction of the substep at which they touch; 1: they only come near
};

struct BodyTouchQuery {
  const Points& points;
  const PointMemory& start;
  const Bodies& bodies;
  const BodyMemory& body_start;
  SolidList hulls;  ///< of the points
  double reach;     ///< m
  const std::vector<TouchForm>& forms;
  const std::vector<uint32_t>& form_of;  ///< row -> form
  const std::vector<PointEdge>& edges;   ///< of the hulls
};

class BodyTouchSearch {
 public:
  const std::vector<BodyTouch>& run(const BodyTouchQuery& q, const ThreadArena& arena);
  /// The body's motion during the substep.
  const Sweep& sweep(size_t body) const { return bodies_[body].sweep; }

 private:
  struct Moving {
    Sweep sweep;
    Transform begin, end;
    double slack;        ///< m, deviation of its places from their chords
    size_t corners = 0;  ///< index of its first corner in `corners_`
    size_t edges = 0;    ///< index of its first edge in `edges_`
  };
  /// A corner's positions at start and end, and what it may touch on its straight path.
  struct MovingCorner {
    Vec3 begin, end;
    Box box;
  };
  void place_bodies(const BodyTouchQuery& q);
  void place_points(const BodyTouchQuery& q);
  void place_corners(const BodyTouchQuery& q);
  void place_edges(const BodyTouchQuery& q);
  template <class Visit>
  void near(const Box& box, Visit&& visit) const;
  void look_at_point(const BodyTouchQuery& q, uint32_t point, std::vector<BodyTouch>& out) const;
  void look_at_hull(const BodyTouchQuery& q, uint32_t hull, std::vector<BodyTouch>& out) const;
  void look_at_edge(const BodyTouchQuery& q, const PointEdge& edge, std::vector<BodyTouch>& out) const;
  std::optional<BodyTouch> touch(const BodyTouchQuery& q, uint32_t point, uint32_t body) const;

  std::vector<Moving> bodies_;
  std::vector<MovingCorner> corners_;  // empty when the points have no hulls
  std::vector<Box> edges_;             // around the paths of bodies' edges
  Box corner_bounds_;
  std::vector<uint8_t> sides_;     // per point, the sides of the corners' bounds that its path lies beyond
  std::vector<Box> boxes_, ways_;  // around bodies, and around the paths of points
  std::vector<uint32_t> unbounded_;
  BoxGrid grid_;
  std::vector<std::vector<BodyTouch>> found_;
  std::vector<BodyTouch> touches_;
};

}  // namespace truestep::contact
