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
  // about its axis, so that their impulses stay with them.
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

}  // namespace

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
