#include "engine/collision/pairs/plane_pairs.h"

#include <cmath>

#include "engine/collision/pairs/face_clip.h"

namespace truestep {
namespace {

/// Collects points of b within the margin; when there are too many, the highest is dropped.
class Below {
 public:
  Below(const Vec3& normal, double margin) : n_(normal), margin_(margin) {}
  void add(const Vec3& p, uint32_t id) {
    const double s = dot(n_, p);
    if (s > margin_) return;
    const ContactPoint c{p - n_ * (0.5 * s), s, id};
    if (list_.count < PointList::kMost) {
      list_.point[list_.count++] = c;
      return;
    }
    int top = 0;
    for (int i = 1; i < list_.count; ++i) {
      if (list_.point[i].separation > list_.point[top].separation) top = i;
    }
    if (s < list_.point[top].separation) list_.point[top] = c;
  }
  void finish(Manifold& out) const {
    out.normal = n_;
    keep_best(list_.all(), n_, out);
  }

 private:
  Vec3 n_;
  double margin_;
  PointList list_;
};

void cylinder_points(const Convex& b, const Transform& place, const Vec3& n, Below& below) {
  const Vec3 d = place.inverse_direction(n);
  const double r = b.size.x, l = std::sqrt(d.x * d.x + d.z * d.z), low = d.y > 0 ? -b.size.y : b.size.y;
  // The lowest point of each rim, and four on which the cylinder stands. They stay in place when it spins
  // about its axis, and keep their impulses.
  if (l > 1e-4) {
    const Vec3 down{-d.x / l * r, 0, -d.z / l * r};
    below.add(place.point({down.x, low, down.z}), 1);
    below.add(place.point({down.x, -low, down.z}), 2);
  }
  constexpr double kLying = 0.3;
  if (std::fabs(d.y) < kLying) return;
  const Vec3 along = place.inverse_direction(cross(n, std::fabs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 e = normalized(Vec3{along.x, 0, along.z}, {1, 0, 0}) * r;
  const uint32_t end = low < 0 ? 3 : 7;
  below.add(place.point({e.x, low, e.z}), end);
  below.add(place.point({-e.z, low, e.x}), end + 1);
  below.add(place.point({-e.x, low, -e.z}), end + 2);
  below.add(place.point({e.z, low, -e.x}), end + 3);
}

/// Selects the vertices that reach furthest along fixed directions.
class Outermost {
 public:
  Outermost(const Vec3& normal, double margin) : n_(normal), margin_(margin) {
    const Vec3 u = normalized(cross(normal, std::fabs(normal.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}),
                              {1, 0, 0}),
               v = cross(normal, u);
    along_[0] = -normal;
    for (int k = 0; k < 4; ++k) {
      constexpr double kCos[4] = {1, 0.7071067811865476, 0, -0.7071067811865476},
                       kSin[4] = {0, 0.7071067811865476, 1, 0.7071067811865476};
      along_[1 + k] = u * kCos[k] + v * kSin[k], along_[5 + k] = -along_[1 + k];
    }
  }
  void add(const Vec3& p, uint32_t id) {
    const double s = dot(n_, p);
    if (s > margin_) return;
    for (int k = 0; k < kDirections; ++k) {
      const double reach = dot(along_[k], p);
      // Among equals, of which a flat face has many, always the same one.
      if (best_[k].id != 0 && (reach < reach_[k] || (reach == reach_[k] && id >= best_[k].id))) continue;
      reach_[k] = reach, best_[k] = {p - n_ * (0.5 * s), s, id};
    }
  }
  void finish(Manifold& out) const {
    ContactPoint points[kDirections];
    size_t count = 0;
    for (const ContactPoint& p : best_) {
      bool known = p.id == 0;
      for (size_t i = 0; i < count; ++i) known = known || points[i].id == p.id;
      if (!known) points[count++] = p;
    }
    out.normal = n_;
    keep_best({points, count}, n_, out);
  }

 private:
  static constexpr int kDirections = 9;
  Vec3 n_;
  double margin_;
  Vec3 along_[kDirections];
  double reach_[kDirections] = {};
  ContactPoint best_[kDirections];
};

}  // namespace

void collide_plane_mesh(const Vec3& n, const TriangleMesh& mesh, const Transform& place, double margin,
                        Manifold& out) {
  out.count = 0;
  const Vec3 d = place.inverse_direction(n);
  const double offset = dot(n, place.position);
  Outermost outermost(n, margin);
  mesh.tree().each(
      [&](const Box& b) {
        const double lowest = d.x * (d.x > 0 ? b.low.x : b.high.x) + d.y * (d.y > 0 ? b.low.y : b.high.y) +
                              d.z * (d.z > 0 ? b.low.z : b.high.z);
        // Boxes are exact, their transform rounds.
        return lowest + offset <= margin + 1e-12 * (std::fabs(lowest) + std::fabs(offset));
      },
      [&](uint32_t i) {
        const MeshTriangle& t = mesh.triangle(i);
        for (size_t k = 0; k < 3; ++k) outermost.add(place.point(t.corner[k]), t.vertex[k] + 1);
      });
  outermost.finish(out);
}

void collide_plane(const Vec3& n, const Convex& b, const Transform& place, double margin, Manifold& out) {
  out.count = 0;
  Below below(n, margin);
  switch (b.kind) {
    case SolidKind::sphere:
      below.add(place.position - n * b.size.x, 1);
      break;
    case SolidKind::capsule: {
      const Vec3 h = axis(place.rotation, 1) * b.size.y, down = n * b.size.x;
      below.add(place.position - h - down, 1);
      below.add(place.position + h - down, 2);
      break;
    }
    case SolidKind::box: {
      const Vec3 x = axis(place.rotation, 0) * b.size.x, y = axis(place.rotation, 1) * b.size.y,
                 z = axis(place.rotation, 2) * b.size.z;
      for (uint32_t i = 0; i < 8; ++i) {
        below.add(place.position + (i & 1 ? x : -x) + (i & 2 ? y : -y) + (i & 4 ? z : -z), i + 1);
      }
      break;
    }
    case SolidKind::cylinder:
      cylinder_points(b, place, n, below);
      break;
    case SolidKind::hull: {
      uint32_t id = 1;
      for (const Vec3& v : b.hull->vertices) below.add(place.point(v), id++);
      break;
    }
    case SolidKind::triangle:
    case SolidKind::plane:
    case SolidKind::mesh:
    case SolidKind::height_field:
    case SolidKind::compound:
      return;
  }
  below.finish(out);
}

}  // namespace truestep
