#include "engine/collision/points/point_contact.h"

#include <limits>

#include "engine/collision/points/collider_set.h"
#include "engine/kernels/contact/contact_response.h"
#include "engine/kernels/contact/first_contact.h"

namespace truestep {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Pose pose_at(const SweptCollider& c, double s) {
  if (c.motion == SweptCollider::Motion::fixed) return c.begin;
  if (s <= 0) return c.begin;
  if (s >= 1) return c.end;
  return {c.begin.position + (c.end.position - c.begin.position) * s,
          nlerp(c.begin.orientation, c.end.orientation, s)};
}

Rotation rotation_at(const SweptCollider& c, const Pose& pose, double s) {
  if (c.motion == SweptCollider::Motion::fixed || s <= 0) return c.begin_rotation;
  return s >= 1 ? c.end_rotation : rotation(pose.orientation);
}

/// Distance kept and outward normal (towards the side where points stay) in the world.
struct WorldDistance {
  double d;
  Vec3 n;
};

WorldDistance clearance_at(const SweptCollider& c, const Vec3& x, double s) {
  const Pose pose = pose_at(c, s);
  const Rotation r = rotation_at(c, pose, s);
  const SurfaceDistance<double> local = solid_distance(c.shape, r.apply_inverse(x - pose.position));
  const double side = c.shape.side == PointSide::outside ? 1 : -1;
  return {side * local.d, r.apply(local.n) * side};
}

/// Fraction of the remaining chord at which the point touches.
std::optional<double> first_touch(const SweptCollider& c, const Vec3& x, const Vec3& end, double from) {
  const Pose pose = pose_at(c, from);
  const Rotation r = rotation_at(c, pose, from);
  const Vec3 p0 = r.apply_inverse(x - pose.position);
  const Vec3 dp = c.end_rotation.apply_inverse(end - c.end.position) - p0;
  const auto distance = [&c](const Vec3& p) { return solid_distance(c.shape, p); };
  const double side = c.shape.side == PointSide::outside ? 1 : -1;
  const SurfaceDistance<double> start = distance(p0);
  if (side * start.d <= c.gap + kContactSlop) {
    // On the surface: sliding along it is not a contact, pressing into it is an immediate one.
    const double pressed = -side * dot(start.n, dp);
    const double deepest = std::max(c.gap - side * start.d, 0.0);
    return pressed + deepest > 1e-3 * kContactSlop ? std::optional(0.0) : std::nullopt;
  }
  return c.shape.side == PointSide::outside ? first_entry(distance, p0, dp, c.gap)
                                            : first_exit(distance, p0, dp, c.gap);
}

/// Displacement of the remaining chord in the solid's own frame, relative to the world at `from`.
Vec3 chord_in_frame(const SweptCollider& c, const Vec3& x, const Vec3& end, double from) {
  if (c.motion == SweptCollider::Motion::fixed) return end - x;
  const Pose pose = pose_at(c, from);
  const Rotation r = rotation_at(c, pose, from);
  const Vec3 p0 = r.apply_inverse(x - pose.position);
  return r.apply(c.end_rotation.apply_inverse(end - c.end.position) - p0);
}

/// World position of the chord's point at the fraction s of the remaining path.
Vec3 chord_point(const SweptCollider& c, const Vec3& x, const Vec3& end, double from, double s) {
  if (c.spin == Vec3{}) return x + (end - x) * s;
  const Pose pose = pose_at(c, from), then = pose_at(c, from + s * (1 - from));
  const Vec3 p0 = rotation_at(c, pose, from).apply_inverse(x - pose.position);
  const Vec3 p1 = c.end_rotation.apply_inverse(end - c.end.position);
  return then.position + rotation(then.orientation).apply(p0 + (p1 - p0) * s);
}

Vec3 surface_velocity(const SweptCollider& c, const Vec3& x, double s) {
  return c.velocity + cross(c.spin, x - pose_at(c, s).position);
}

/// Contact time on the parabola x + v T + a T^2/2 near the chord's s (both as fractions of the remaining
/// path).
double refined(const SweptCollider& c, const PointFlight& f, double s, double tau) {
  double best = s, t = s;
  for (int i = 0; i < 4; ++i) {
    const double dt = t * tau, at = f.from + t * (1 - f.from);
    const WorldDistance w = clearance_at(c, f.x + f.v * dt + f.a * (0.5 * dt * dt), at);
    const double slope = dot(w.n, f.v + f.a * dt - surface_velocity(c, f.x, at)) * tau;
    if (slope >= 0) return s;
    const double next = t - (w.d - c.gap) / slope;
    if (!(next >= 0 && next <= 1)) return s;
    best = next;
    if (std::fabs(next - t) < 1e-12) break;
    t = next;
  }
  return best;
}

}  // namespace

SweptCollider sweep_collider(const Collider& c, const Surface& surface, double t, double h, double radius) {
  SweptCollider s;
  s.shape = c.shape;
  s.surface = surface;
  s.gap = radius + kContactSlop;
  s.begin = s.end = c.start;
  if (!c.motion.at_rest()) {
    s.motion = SweptCollider::Motion::moving;
    s.begin = moved(c.start, c.motion, t);
    s.end = moved(c.start, c.motion, t + h);
    if (h > 0) s.velocity = (s.end.position - s.begin.position) / h;
    s.spin = c.motion.spin;
  }
  s.begin_rotation = rotation(s.begin.orientation);
  s.end_rotation = rotation(s.end.orientation);
  if (c.shape.kind == ShapeKind::plane) {
    s.end_normal = s.end_rotation.apply(c.shape.size);
    s.end_level = dot(s.end_normal, s.end.position) + s.gap + kContactSlop;
  }

  // Half size of the shape's box at one end of the step; a turning shape gets its ball.
  const auto reach = [&](const Rotation& r) -> Vec3 {
    if (c.shape.kind == ShapeKind::box && s.spin == Vec3{}) {
      Vec3 e;
      double* out[3] = {&e.x, &e.y, &e.z};
      for (int i = 0; i < 3; ++i) {
        *out[i] = std::fabs(r.row[i].x) * c.shape.size.x + std::fabs(r.row[i].y) * c.shape.size.y +
                  std::fabs(r.row[i].z) * c.shape.size.z;
      }
      return e;
    }
    const double ball = bounding_radius(c.shape);
    return {ball, ball, ball};
  };
  const double pad = s.gap + kContactSlop;
  const Vec3 e = reach(s.begin_rotation) + Vec3{pad, pad, pad};
  const Vec3 &p = s.begin.position, &q = s.end.position;
  s.low = Vec3{std::min(p.x, q.x), std::min(p.y, q.y), std::min(p.z, q.z)} - e;
  s.high = Vec3{std::max(p.x, q.x), std::max(p.y, q.y), std::max(p.z, q.z)} + e;

  s.safe_low = {kInfinity, kInfinity, kInfinity};
  s.safe_high = -s.safe_low;
  if (c.shape.side == PointSide::inside && s.motion == SweptCollider::Motion::fixed) {
    // The box's own extents when it is not rotated, otherwise the cube that fits into any container.
    Vec3 safe{0, 0, 0};
    if (c.shape.kind == ShapeKind::box) {
      const double m = std::min({c.shape.size.x, c.shape.size.y, c.shape.size.z}) / std::sqrt(3.0);
      safe = c.start.orientation == Quat{} ? c.shape.size : Vec3{m, m, m};
    } else {
      const double m = c.shape.size.x / std::sqrt(3.0);
      safe = {m, m, m};
    }
    safe -= Vec3{pad, pad, pad};
    s.safe_low = p - safe;
    s.safe_high = p + safe;
  }
  return s;
}

bool held_by(const SweptCollider& c, const Vec3& b) {
  if (b.x >= c.safe_low.x && b.y >= c.safe_low.y && b.z >= c.safe_low.z && b.x <= c.safe_high.x &&
      b.y <= c.safe_high.y && b.z <= c.safe_high.z) {
    return true;
  }
  return clearance_at(c, b, 1).d > c.gap + kContactSlop;
}

namespace {

/// The forces in the frame of a rotating solid, in the axes at the moment `f.from`: the centrifugal and
/// Coriolis accelerations of a point with velocity u there, `later` (s) on.
Vec3 acceleration_in_frame(const SweptCollider& c, const PointFlight& f, const Vec3& u, double later) {
  const Vec3 r = f.x - pose_at(c, f.from).position + u * later;
  // In that frame the forces rotate backwards.
  const Vec3 a = f.a - cross(c.spin, f.a) * later;
  return a - cross(c.spin, u) * 2 - cross(c.spin, cross(c.spin, r));
}

/// Carries `f` along on a rotating solid: support in the solid's own frame under the acceleration at the
/// middle of the remaining time (s), then the parabola in the world with the same end and the same velocity
/// there. Position and velocity are second order; in the world's frame the velocity would lag by a step.
void carry_round(const SweptCollider& c, PointFlight& f, const Vec3& n, const Vec3& relative, double left) {
  const double friction = c.surface.friction;
  Vec3 a = acceleration_in_frame(c, f, relative - n * dot(relative, n), 0);
  Support<double> held = support(relative, a, n, friction, left);
  const Vec3 middle = held.velocity + held.acceleration * (0.5 * left);
  a = acceleration_in_frame(c, f, middle, 0.5 * left);
  held = support(relative, a, n, friction, left);

  const Pose pose = pose_at(c, f.from);
  const Rotation then = rotation_at(c, pose, f.from);
  const auto at_end = [&](const Vec3& u) { return c.end_rotation.apply(then.apply_inverse(u)); };
  const Vec3 way = held.velocity * left + held.acceleration * (0.5 * left * left);
  const Vec3 x = c.end.position + at_end(f.x - pose.position + way);
  const Vec3 v = surface_velocity(c, x, 1) + at_end(held.velocity + held.acceleration * left);
  f.a = (v * left - (x - f.x)) * (2 / (left * left));
  f.v = v - f.a * left;
}

/// Velocity and acceleration of `f`, which touches `c`, after the contact; returns whether the wall now
/// carries it.
enum class Outcome : uint8_t { bounced, carried };
Outcome answer(const SweptCollider& c, PointFlight& f, const WorldDistance& w, const Vec3* resting_velocity,
               Vec3& offset, double h) {
  const Vec3 surface = surface_velocity(c, f.x, f.from);
  const bool turns = c.spin != Vec3{};
  const double left = (1 - f.from) * h;
  Vec3 relative = f.v - surface;
  double pull = -dot(turns ? acceleration_in_frame(c, f, relative, 0) : f.a, w.n);
  const auto rests = [&](double approach) {
    // A bounce whose flight 2 e v / a ends within the step counts as rest.
    return approach <= c.surface.rest_speed || c.surface.restitution * approach <= 0.51 * pull * h;
  };
  if (resting_velocity && rests(-dot(*resting_velocity - surface, w.n))) {
    // The point was resting here when the step began: its own velocity counts, not the integrator's free
    // path.
    relative = *resting_velocity - surface;
    if (turns) pull = -dot(acceleration_in_frame(c, f, relative, 0), w.n);
    offset = {};
  }
  const double approach = -dot(relative, w.n);
  if (approach > 0 && !rests(approach)) {
    f.v = surface + impact(relative, w.n, c.surface.restitution, c.surface.friction);
    return Outcome::bounced;
  }
  f.v = surface + relative;
  if (turns && left > 0 && (pull > 0 || approach > 0)) {
    carry_round(c, f, w.n, relative, left);
    offset -= w.n * dot(offset, w.n);
    return Outcome::carried;
  }
  if (pull > 0 || approach > 0) {
    const Support<double> held = support(relative, f.a, w.n, c.surface.friction, left);
    f.v = surface + held.velocity;
    f.a = held.acceleration;
    offset -= w.n * dot(offset, w.n);
  }
  // A rotating solid pushes what it carries: the chord must not enter it.
  const Vec3 end = f.x + f.v * left + f.a * (0.5 * left * left);
  const double enters = -dot(w.n, chord_in_frame(c, f.x, end, f.from));
  if (enters > 0 && left > 0) {
    const Vec3 push = w.n * (enters / left), along = f.v - surface - w.n * dot(f.v - surface, w.n);
    const double speed = norm(along), grip = c.surface.friction * enters / left;
    f.v += push - along * (speed > grip ? grip / speed : 1.0);
  }
  return Outcome::carried;
}

/// A point that slid along a concave wall ends beyond it: it is moved back onto the wall and its velocity
/// turned into the wall's tangent, keeping its energy (`work`, J/kg, is the work of the forces on the way
/// back to the wall) less the friction of the turn.
void follow_wall(const SweptCollider& c, PointFlight& f, const WorldDistance& w, double work) {
  const Vec3 surface = surface_velocity(c, f.x, 1), relative = f.v - surface;
  const double into = -dot(relative, w.n);
  if (into <= 0) return;
  const Vec3 along = relative + w.n * into;
  const double speed = std::sqrt(std::max(norm2(relative) + 2 * work, 0.0)), length = norm(along);
  if (length > 0) f.v = surface + along * (std::max(speed - c.surface.friction * into, 0.0) / length);
}

}  // namespace

PointEnd advance_point(std::span<const SweptCollider> colliders, PointFlight f, const Vec3& v_old,
                       Vec3 offset, double h) {
  const SweptCollider* carrier = nullptr;
  const Vec3 free = f.a;
  for (int contacts = 0;; ++contacts) {
    const double tau = (1 - f.from) * h;
    const Vec3 end = f.x + f.v * tau + f.a * (0.5 * tau * tau);
    double s = 2;
    const SweptCollider* hit = nullptr;
    for (const SweptCollider& c : colliders) {
      if (clear_of(c, f.x, end)) continue;
      const auto touch = first_touch(c, f.x, end, f.from);
      if (touch && *touch < s) s = *touch, hit = &c;
    }
    if (!hit) {
      f.x = end;
      f.v += f.a * tau;
      break;
    }
    if (contacts == kMaxContacts) break;  // wedged: stays on the surface until the next step

    const bool at_start = contacts == 0 && s == 0;
    if (s > 0) {
      const double better = refined(*hit, f, s, tau), dt = better * tau;
      f.x = better == s ? chord_point(*hit, f.x, end, f.from, s) : f.x + f.v * dt + f.a * (0.5 * dt * dt);
      f.v += f.a * dt;
      f.from += better * (1 - f.from);
    }
    const WorldDistance w = clearance_at(*hit, f.x, f.from);
    if (s > 0 || w.d < hit->gap) f.x += w.n * (hit->gap - w.d);
    const Outcome outcome = answer(*hit, f, w, at_start ? &v_old : nullptr, offset, h);
    carrier = outcome == Outcome::carried ? hit : nullptr;
  }
  for (const SweptCollider& c : colliders) {
    if (clear_of(c, f.x, f.x)) continue;
    const WorldDistance w = clearance_at(c, f.x, 1);
    if (w.d >= c.gap - kContactSlop) continue;
    const Vec3 back = w.n * (c.gap - w.d);
    f.x += back;
    if (&c == carrier) follow_wall(c, f, w, dot(free, back));
  }
  return {f.x, f.v + offset};
}

}  // namespace truestep
