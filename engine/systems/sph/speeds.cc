#include "engine/systems/sph/speeds.h"

#include <algorithm>
#include <cmath>

namespace truestep::sph {

namespace {

constexpr double kTwoPi = 6.28318530717958647692;

/// m, distance of the farthest corner of the box from a point.
double farthest_corner(const SphDef& d, const Vec3& from) {
  const Vec3 a = d.low - from, b = d.high - from;
  return norm(Vec3{std::max(std::abs(a.x), std::abs(b.x)), std::max(std::abs(a.y), std::abs(b.y)),
                   d.dimension == 3 ? std::max(std::abs(a.z), std::abs(b.z)) : 0});
}

/// What moves, and how far from its origin it reaches (m).
struct Mover {
  const Pose& start;
  const ShapeMotion& motion;
  double radius;
};
Mover mover(const Collider& c) {
  return {c.start, c.motion, bounding_radius(c.shape)};
}
Mover mover(const MeshWall& m) {
  return {m.collider.start, m.collider.motion, bounding_radius(m.collider.solid)};
}

/// m/s, of any point of a collider in the box, at any time.
double fastest_point(const SphDef& d, const Mover& c) {
  const ShapeMotion& m = c.motion;
  const double steady = norm(m.velocity), swing = kTwoPi * m.frequency * norm(m.amplitude);
  if (m.spin == Vec3{}) return steady + swing;
  const double reach = std::min(c.radius, farthest_corner(d, c.start.position));
  return steady + swing + norm(m.spin) * reach;
}

/// m, of the lowest place along `up` that liquid can reach: on the box, and on whatever it cannot get past.
double bottom_of(const SphDef& d, const ColliderSet& colliders, std::span<const MeshWall> meshes,
                 const Vec3& up) {
  const auto lowest = [&](const Vec3& center, const Vec3& half) {
    const double z = d.dimension == 3 ? half.z * std::abs(up.z) : 0;
    return dot(center, up) - (half.x * std::abs(up.x) + half.y * std::abs(up.y) + z);
  };
  const auto across = [&](const Vec3& n) { return dot(n, up) > (1 - 1e-12) * norm(n); };
  double out = std::min(d.low.x * up.x, d.high.x * up.x) + std::min(d.low.y * up.y, d.high.y * up.y) +
               std::min(d.low.z * up.z, d.high.z * up.z);
  for (const KillPlaneDef& k : d.kill_planes) {
    if (across(k.normal)) out = std::max(out, dot(k.point, up));
  }
  for (const KillBoxDef& k : d.kill_boxes) {
    if (k.where == KillBoxDef::Where::outside) out = std::max(out, lowest(k.center, k.half_extents));
  }
  for (const Collider& c : colliders.colliders()) {
    if (!c.motion.at_rest()) continue;
    const double place = dot(c.start.position, up);
    if (c.shape.kind == ShapeKind::plane) {
      if (across(rotation(c.start.orientation).apply(c.shape.size))) out = std::max(out, place);
    } else if (c.shape.side == PointSide::inside) {
      out = std::max(out, place - bounding_radius(c.shape));
    }
  }
  for (const MeshWall& m : meshes) {
    const bool holds = m.collider.side == PointSide::inside && m.collider.motion.at_rest();
    if (holds) out = std::max(out, dot(m.collider.start.position, up) - bounding_radius(m.collider.solid));
  }
  return out;
}

}  // namespace

double expected_speed(const SphDef& d, const ColliderSet& colliders, std::span<const MeshWall> meshes,
                      const Vec3& gravity, double fastest_initial) {
  const bool plane = d.dimension == 2;
  const Vec3 pull{gravity.x, gravity.y, plane ? 0 : gravity.z};
  const double g = norm(pull);
  const Vec3 up = g > 0 ? pull / -g : Vec3{0, 1, 0};
  const double bottom = bottom_of(d, colliders, meshes, up);
  double top = bottom, speed = norm(d.lid_velocity);
  for (const BodyDef& b : d.bodies) {
    const bool ball = b.shape == Shape::ball;
    const Vec3 reach = ball ? Vec3{b.radius, b.radius, b.radius} : b.half_extents;
    const double widest = plane ? std::sqrt(reach.x * reach.x + reach.y * reach.y) : norm(reach);
    const double above =
        ball ? b.radius : reach.x * std::abs(up.x) + reach.y * std::abs(up.y) + reach.z * std::abs(up.z);
    top = std::max(top, dot(b.center, up) + above);
    const double strain = std::max({std::abs(b.strain.x), std::abs(b.strain.y), std::abs(b.strain.z)});
    speed = std::max(speed, norm(b.velocity) + (norm(b.spin) + strain) * widest + fastest_initial);
  }
  for (const InletDef& e : d.emitters) {
    top = std::max(top, dot(e.position, up) + e.radius);
    speed = std::max(speed, std::abs(e.speed));
  }
  for (const Collider& c : colliders.colliders()) speed = std::max(speed, fastest_point(d, mover(c)));
  for (const MeshWall& m : meshes) speed = std::max(speed, fastest_point(d, mover(m)));
  const Vec3 size = d.high - d.low;
  const double tallest = size.x * std::abs(up.x) + size.y * std::abs(up.y) + size.z * std::abs(up.z);
  return std::sqrt(speed * speed + 2 * g * std::min(top - bottom, tallest));
}

double fastest_wall(const SphDef& d, const ColliderSet& colliders, std::span<const MeshWall> meshes, double t,
                    double h) {
  double out = d.walls == Walls::no_slip ? norm(d.lid_velocity) : 0;
  const auto count = [&](const Mover& c) {
    if (c.motion.at_rest()) return;
    const double speed = fastest_point(d, c);
    // A collider that has left the box, or has not come in yet, moves nothing.
    const double margin = c.radius + speed * h + d.support * d.spacing;
    const Vec3 p = moved(c.start, c.motion, t).position;
    // Along periodic axes its images go on.
    const auto off = [&](int axis, double x, double low, double high) {
      return !d.wraps(axis) && (x < low - margin || x > high + margin);
    };
    const bool away = off(0, p.x, d.low.x, d.high.x) || off(1, p.y, d.low.y, d.high.y) ||
                      (d.dimension == 3 && off(2, p.z, d.low.z, d.high.z));
    if (!away) out = std::max(out, speed);
  };
  for (const Collider& c : colliders.colliders()) count(mover(c));
  for (const MeshWall& m : meshes) count(mover(m));
  return out;
}

}  // namespace truestep::sph
