#include "engine/sinks/picture/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/sinks/picture/pose.h"

namespace truestep::picture {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;

bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

struct Ball {
  Vec3 centre;
  double radius;
};

template <class Visit>
void for_each_ball(const DrawList& list, Visit visit) {
  for (const DrawPoints& set : list.points) {
    const size_t n = set.positions.size() / 3;
    for (size_t i = 0; i < n; ++i) {
      const Vec3f p = load3(set.positions.data(), i);
      const Vec3 c{p.x, p.y, p.z};
      const float r = set.radii.size() == n ? set.radii[i] : set.radius;
      if (finite(c) && std::isfinite(r)) visit(Ball{c, std::max(0.0f, r)});
    }
  }
  for (const Vec3& p : list.framed) visit(Ball{p, 0});
  for (const DrawShape& s : list.shapes) {
    if (!finite(s.position) || !finite(s.size) || s.framing == DrawShape::Framing::ignored) continue;
    const Pose pose(s);
    const double r = std::abs(s.size.x);
    switch (s.kind) {
      case DrawShape::Kind::plane:
        break;
      case DrawShape::Kind::sphere:
        visit(Ball{s.position, r});
        break;
      case DrawShape::Kind::capsule:
        for (double end : {-s.size.y, s.size.y}) visit(Ball{pose.point({0, end, 0}), r});
        break;
      case DrawShape::Kind::cylinder:
        for (const Vec3& corner : {Vec3{r, 0, 0}, {-r, 0, 0}, {0, 0, r}, {0, 0, -r}})
          for (double end : {-s.size.y, s.size.y}) visit(Ball{pose.point(corner + Vec3{0, end, 0}), 0});
        break;
      case DrawShape::Kind::mesh:
        for (size_t i = 0; s.mesh && i < s.mesh->positions.size() / 3; ++i) {
          const Vec3f p = load3(s.mesh->positions.data(), i);
          visit(Ball{pose.point({p.x, p.y, p.z}), 0});
        }
        break;
      case DrawShape::Kind::box:
        for (int corner = 0; corner < 8; ++corner)
          visit(Ball{pose.point({corner & 1 ? s.size.x : -s.size.x, corner & 2 ? s.size.y : -s.size.y,
                                 corner & 4 ? s.size.z : -s.size.z}),
                     0});
        break;
    }
  }
}

/// Smallest numbers that bound s (c.axis) + k (c.back) + r sqrt(1 + k^2) over all balls, for s = +1 and -1.
struct Slab {
  double plus = -std::numeric_limits<double>::infinity(), minus = plus;
  void add(const Ball& ball, const Vec3& axis, const Vec3& back, double k) {
    const double reach = k * dot(ball.centre, back) + ball.radius * std::sqrt(1 + k * k);
    plus = std::max(plus, dot(ball.centre, axis) + reach);
    minus = std::max(minus, -dot(ball.centre, axis) + reach);
  }
};

}  // namespace

Axes axes_of(const Vec3& up_hint) {
  const Vec3 up = normalized(finite(up_hint) ? up_hint : Vec3{0, 1, 0}, {0, 1, 0});
  // y-up looks along z as most scenes do; for another up, the horizontal axis farthest from it is used.
  const Vec3 hint = std::abs(up.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{0, -1, 0};
  const Vec3 side = normalized(cross(up, hint));
  return {side, up, cross(side, up)};
}

DrawCamera camera_for(const DrawList& list, double aspect) {
  if (list.camera && finite(list.camera->eye) && finite(list.camera->target) &&
      norm2(list.camera->eye - list.camera->target) > 0) {
    DrawCamera given = *list.camera;
    given.fov_degrees = std::isfinite(given.fov_degrees) ? std::clamp(given.fov_degrees, 1.0, 160.0) : 35.0;
    if (!given.up || !finite(*given.up)) given.up = list.up;
    return given;
  }
  DrawCamera camera;
  camera.up = list.up, camera.fov_degrees = list.fov_degrees;
  const Axes axes = axes_of(list.up);
  const Vec3 oblique = axes.side * 0.5 + axes.up * 0.42 + axes.front;
  // Never exactly along `up`, or the picture would have no upright direction.
  const Vec3 back = normalized(list.facing ? *list.facing + axes.front * 1e-3 : oblique);
  const Vec3 right = normalized(cross(axes.up, back)), above = cross(back, right);
  const double ky = std::tan(camera.fov_degrees * kRadiansPerDegree / 2) * list.fill, kx = ky * aspect;
  Slab horizontal, vertical;
  double nearest = -std::numeric_limits<double>::infinity(), farthest = -nearest;
  for_each_ball(list, [&](const Ball& ball) {
    horizontal.add(ball, right, back, kx);
    vertical.add(ball, above, back, ky);
    nearest = std::max(nearest, dot(ball.centre, back) + ball.radius);
    farthest = std::min(farthest, dot(ball.centre, back) - ball.radius);
  });
  if (!(nearest >= farthest)) {  // nothing to see
    camera.eye = back * 4.0;
    return camera;
  }
  const double x = (horizontal.plus - horizontal.minus) / 2, y = (vertical.plus - vertical.minus) / 2;
  double d =
      std::max((horizontal.plus + horizontal.minus) / (2 * kx), (vertical.plus + vertical.minus) / (2 * ky));
  const double middle = (nearest + farthest) / 2;
  // A lone point without radius has no size: step back by one metre or a millionth of its coordinates.
  const double least =
      std::max({1e-6 * (std::abs(x) + std::abs(y) + std::abs(middle)), (nearest - farthest) / 2, 0.0});
  if (d - middle <= least) d = middle + (least > 0 ? 2 * least : 1.0);
  camera.eye = right * x + above * y + back * d;
  camera.target = right * x + above * y + back * middle;
  return camera;
}

}  // namespace truestep::picture
