#include "engine/systems/fem/barrier/barrier_surface.h"

#include <algorithm>

#include "engine/collision/broad/box_grid.h"

namespace truestep::fem {

namespace {

Box box_around(std::span<const uint32_t> rows, std::span<const double> x, std::span<const double> d,
               double grow) {
  Box out = Box::nothing();
  for (const uint32_t r : rows) {
    const Vec3 p = load3(x.data(), r);
    out.cover(p);
    if (!d.empty()) out.cover(p + load3(d.data(), r));
  }
  return out.grown(grow);
}

// Whether the segment p q intersects the triangle a b c (Moeller, Trumbore 1997).
bool pierces(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 along = q - p, e1 = b - a, e2 = c - a, h = cross(along, e2);
  const double det = dot(e1, h);
  // Coplanar up to rounding: then other features would touch.
  if (det * det <= 1e-24 * norm2(along) * norm2(e1) * norm2(e2)) return false;
  const Vec3 s = p - a, k = cross(s, e1);
  const double u = dot(s, h) / det, v = dot(along, k) / det, t = dot(e2, k) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t <= 1;
}

}  // namespace

BarrierSurface::BarrierSurface(const Body& body, const ColliderSet& colliders,
                               std::span<const Surface> surfaces, double own_friction)
    : nodes_(body.mesh.x.size()), own_friction_(own_friction), colliders_(colliders) {
  for (const Surface& s : surfaces) frictions_.push_back(s.friction);
  const auto own = static_cast<float>(own_friction);
  std::vector<std::array<uint32_t, 2>> edges;
  for (const auto& t : body.mesh.triangles()) {
    triangles_.push_back({t, own});
    for (size_t a = 0; a < 3; ++a) {
      const uint32_t p = t[a], q = t[(a + 1) % 3];
      edges.push_back({std::min(p, q), std::max(p, q)});
      points_.push_back(p);
    }
  }
  const auto once = [](auto& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  once(edges), once(points_);
  for (const auto& e : edges) {
    const double length2 = norm2(body.mesh.x[e[1]] - body.mesh.x[e[0]]);
    shortest_ = std::min(shortest_, std::sqrt(length2));
    edges_.push_back({e, length2, 0, own});
  }
  for (const uint32_t p : points_) all_points_.push_back({p, 0, own});
  for (uint32_t k = 0; k < colliders_.colliders().size(); ++k) add_obstacle(colliders_.colliders()[k], k);
}

void BarrierSurface::add_obstacle(const Collider& c, uint32_t index) {
  const Shape& shape = c.shape;
  const bool box = shape.kind == ShapeKind::box;
  if (shape.kind == ShapeKind::plane || shape.side == PointSide::inside) {
    if (box) {
      for (int8_t face = 0; face < 6; ++face) walls_.push_back({index, face});
    } else {
      walls_.push_back({index, -1});
    }
    return;
  }
  const auto friction = static_cast<float>(frictions_[index]);
  const auto first = static_cast<uint32_t>(rows());
  const auto edge = [&](uint32_t a, uint32_t b, float radius) {
    const std::array<uint32_t, 2> rows{first + a, first + b};
    edges_.push_back(
        {rows, norm2(corners_[rows[1] - nodes_].at - corners_[rows[0] - nodes_].at), radius, friction});
  };
  const auto corner = [&](const Vec3& at, float radius) {
    all_points_.push_back({static_cast<uint32_t>(rows()), radius, friction});
    corners_.push_back({index, at});
  };
  if (!box) {
    const auto r = static_cast<float>(shape.size.x);
    const bool capsule = shape.kind == ShapeKind::capsule;
    corner({0, capsule ? -shape.size.y : 0, 0}, r);
    if (!capsule) return;
    corner({0, shape.size.y, 0}, r);
    return edge(0, 1, r);
  }
  for (uint32_t k = 0; k < 8; ++k) {
    corner({k & 1 ? shape.size.x : -shape.size.x, k & 2 ? shape.size.y : -shape.size.y,
            k & 4 ? shape.size.z : -shape.size.z},
           0);
  }
  constexpr std::array<std::array<uint32_t, 4>, 6> kFaces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : kFaces) {
    triangles_.push_back({{first + f[0], first + f[1], first + f[2]}, friction});
    triangles_.push_back({{first + f[0], first + f[2], first + f[3]}, friction});
  }
  for (uint32_t k = 0; k < 8; ++k) {
    for (const uint32_t bit : {1u, 2u, 4u}) {
      if (!(k & bit)) edge(k, k | bit, 0);
    }
  }
}

void BarrierSurface::place_obstacles(double t, std::span<double> x) const {
  for (size_t k = 0; k < corners_.size(); ++k) {
    const Collider& c = colliders_.colliders()[corners_[k].collider];
    const Pose at = moved(c.start, c.motion, t);
    store3(x.data(), nodes_ + k, at.position + rotation(at.orientation).apply(corners_[k].at));
  }
}

// An obstacle's coefficient wins; pairs of the body's own features share one.
double BarrierSurface::pair_friction(uint32_t a, float of_a, uint32_t b, float of_b) const {
  return !of_body(a) ? of_a : !of_body(b) ? of_b : own_friction_;
}

void BarrierSurface::find_pairs(std::span<const double> x, std::span<const double> d, double reach,
                                std::vector<FeaturePair>& out) const {
  out.clear();
  std::vector<Box> boxes;
  BoxGrid grid;
  for (const Triangle& t : triangles_) boxes.push_back(box_around(t.rows, x, d, reach));
  grid.build(boxes);
  std::vector<uint32_t> found;
  for (const Point& p : all_points_) {
    found.clear();
    const std::array<uint32_t, 1> row{p.row};
    grid.overlapping(box_around(row, x, d, p.radius), [&](uint32_t k) { found.push_back(k); });
    std::sort(found.begin(), found.end());
    for (const uint32_t k : found) {
      const Triangle& t = triangles_[k];
      if (!of_body(p.row) && !of_body(t.rows[0])) continue;
      if (p.row == t.rows[0] || p.row == t.rows[1] || p.row == t.rows[2]) continue;
      out.push_back({{p.row, t.rows[0], t.rows[1], t.rows[2]},
                     false,
                     p.radius,
                     static_cast<float>(pair_friction(p.row, p.friction, t.rows[0], t.friction)),
                     0});
    }
  }
  boxes.clear();
  for (const Edge& e : edges_) boxes.push_back(box_around(e.rows, x, d, 0.5 * reach + double(e.radius)));
  grid.build(boxes);
  for (uint32_t k = 0; k < edges_.size(); ++k) {
    const Edge& e = edges_[k];
    found.clear();
    grid.overlapping(boxes[k], [&](uint32_t other) {
      if (other > k) found.push_back(other);
    });
    std::sort(found.begin(), found.end());
    for (const uint32_t other : found) {
      const Edge& f = edges_[other];
      if (!of_body(e.rows[0]) && !of_body(f.rows[0])) continue;
      if (e.rows[0] == f.rows[0] || e.rows[0] == f.rows[1] || e.rows[1] == f.rows[0] ||
          e.rows[1] == f.rows[1])
        continue;
      out.push_back({{e.rows[0], e.rows[1], f.rows[0], f.rows[1]},
                     true,
                     e.radius + f.radius,
                     static_cast<float>(pair_friction(e.rows[0], e.friction, f.rows[0], f.friction)),
                     1e-3 * e.length2 * f.length2});
    }
  }
}

WallGap BarrierSurface::wall_gap(const Wall& wall, double t, const Vec3& x) const {
  const Collider& c = colliders_.colliders()[wall.collider];
  const Pose at = moved(c.start, c.motion, t);
  const Rotation r = rotation(at.orientation);
  const Vec3 p = r.apply_inverse(x - at.position);
  if (wall.face >= 0) {
    const double along[3] = {p.x, p.y, p.z}, half[3] = {c.shape.size.x, c.shape.size.y, c.shape.size.z};
    const int axis = wall.face / 2;
    const double sign = wall.face % 2 ? 1 : -1;
    Vec3 n;
    (axis == 0 ? n.x : axis == 1 ? n.y : n.z) = -sign;
    return {half[axis] - sign * along[axis], r.apply(n)};
  }
  const SurfaceDistance<double> d = solid_distance(c.shape, p);
  const double side = c.shape.side == PointSide::inside ? -1 : 1;
  return {side * d.d, r.apply(side * d.n)};
}

Vec3 BarrierSurface::wall_shift(const Wall& wall, double t0, double t, const Vec3& x) const {
  const Collider& c = colliders_.colliders()[wall.collider];
  if (c.motion.at_rest()) return {};
  const Pose now = moved(c.start, c.motion, t), then = moved(c.start, c.motion, t0);
  const Vec3 own = rotation(now.orientation).apply_inverse(x - now.position);
  return x - (then.position + rotation(then.orientation).apply(own));
}

std::optional<std::string> BarrierSurface::entangled(std::span<const double> nodes, double t) const {
  std::vector<double> x(nodes.begin(), nodes.end());
  x.resize(3 * rows());
  place_obstacles(t, x);
  const auto name = [&](uint32_t collider) {
    const std::string& id = colliders_.colliders()[collider].id;
    return id.empty() ? "collider " + std::to_string(collider) : "collider \"" + id + "\"";
  };
  const auto owner = [&](uint32_t row) {
    return of_body(row) ? "the body itself (near node " + std::to_string(row) + ")"
                        : name(corners_[row - nodes_].collider);
  };
  for (const uint32_t p : points_) {
    const Vec3 at = load3(x.data(), p);
    for (const Wall& w : walls_) {
      if (!(wall_gap(w, t, at).gap > 0))
        return "node " + std::to_string(p) + " is inside " + name(w.collider);
    }
    for (uint32_t k = 0; k < colliders_.colliders().size(); ++k) {
      const Collider& c = colliders_.colliders()[k];
      if (c.shape.kind == ShapeKind::plane || c.shape.side == PointSide::inside) continue;
      const Pose pose = moved(c.start, c.motion, t);
      const Vec3 own = rotation(pose.orientation).apply_inverse(at - pose.position);
      if (!(solid_distance(c.shape, own).d > 0)) return "node " + std::to_string(p) + " is inside " + name(k);
    }
  }
  std::vector<FeaturePair> pairs;
  find_pairs(x, {}, 0, pairs);
  for (const FeaturePair& p : pairs) {
    if (!(p.closest(p.at(x)).distance > static_cast<double>(p.radius)))
      return owner(p.rows[0]) + " touches " + owner(p.rows[2]);
  }
  std::vector<Box> boxes;
  for (const Triangle& tri : triangles_) boxes.push_back(box_around(tri.rows, x, {}, 0));
  BoxGrid grid;
  grid.build(boxes);
  for (const Edge& e : edges_) {
    std::optional<uint32_t> through;
    grid.overlapping(box_around(e.rows, x, {}, 0), [&](uint32_t k) {
      const auto& r = triangles_[k].rows;
      if (through || (!of_body(e.rows[0]) && !of_body(r[0]))) return;
      for (const uint32_t p : r) {
        if (p == e.rows[0] || p == e.rows[1]) return;
      }
      if (pierces(load3(x.data(), e.rows[0]), load3(x.data(), e.rows[1]), load3(x.data(), r[0]),
                  load3(x.data(), r[1]), load3(x.data(), r[2])))
        through = k;
    });
    if (through) return owner(e.rows[0]) + " goes through " + owner(triangles_[*through].rows[0]);
  }
  return std::nullopt;
}

}  // namespace truestep::fem
