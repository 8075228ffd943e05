#include "engine/collision/queries/ray_cast.h"

#include <algorithm>
#include <cmath>

#include "engine/geometry/compound.h"
#include "engine/geometry/height_field.h"

namespace truestep {
namespace {

/// The part of a ray that is inside all half spaces seen so far.
class Clip {
 public:
  explicit Clip(double most) : leave_(most) {}
  /// Half space n . x <= offset.
  void cut(const Vec3& n, double offset, const Ray& r) {
    const double above = dot(n, r.origin) - offset, rate = dot(n, r.direction);
    if (rate == 0) {
      if (above > 0) leave_ = -1;
    } else if (rate < 0) {
      if (-above / rate > enter_) enter_ = -above / rate, normal_ = n;
    } else {
      leave_ = std::min(leave_, -above / rate);
    }
  }
  std::optional<RayHit> hit(const Ray& r) const {
    if (enter_ > leave_) return std::nullopt;
    return RayHit{enter_, enter_ > 0 ? normal_ : normalized(-r.direction)};
  }

 private:
  double enter_ = 0, leave_;
  Vec3 normal_;
};

/// Times at which |o + t d| = r for two- or three-dimensional o and d; empty when missed. Accurate for far
/// origins: the nearest approach is found first.
std::optional<std::pair<double, double>> circle_times(const Vec3& o, const Vec3& d, double r) {
  const double dd = norm2(d);
  if (!(dd > 0)) return std::nullopt;
  const double middle = -dot(o, d) / dd;
  const double left = r * r - norm2(o + d * middle);
  if (left < 0) return std::nullopt;
  const double half = std::sqrt(left / dd);
  return std::pair(middle - half, middle + half);
}

std::optional<RayHit> on_ball(const Vec3& center, double r, const Ray& ray, double most) {
  const Vec3 o = ray.origin - center;
  if (norm2(o) <= r * r) return RayHit{0, normalized(-ray.direction)};
  const auto times = circle_times(o, ray.direction, r);
  if (!times || times->first < 0 || times->first > most) return std::nullopt;
  return RayHit{times->first, normalized(o + ray.direction * times->first)};
}

/// The tube |(x, z)| <= r between -h and h, as an interval of times with the normal at its start.
std::optional<RayHit> on_cylinder(double r, double h, const Ray& ray, double most) {
  const Vec3 o{ray.origin.x, 0, ray.origin.z}, d{ray.direction.x, 0, ray.direction.z};
  Clip caps(most);
  caps.cut({0, 1, 0}, h, ray);
  caps.cut({0, -1, 0}, h, ray);
  const auto slab = caps.hit(ray);
  if (!slab) return std::nullopt;
  const bool upright = !(norm2(d) > 0);
  if (upright) return norm2(o) <= r * r ? slab : std::nullopt;
  const auto times = circle_times(o, d, r);
  if (!times || times->second < 0 || times->first > most) return std::nullopt;
  if (times->first <= slab->t) return times->second >= slab->t ? slab : std::nullopt;
  if (std::fabs(ray.origin.y + ray.direction.y * times->first) > h) return std::nullopt;
  return RayHit{times->first, normalized(o + d * times->first)};
}

std::optional<RayHit> earlier(const std::optional<RayHit>& a, const std::optional<RayHit>& b) {
  return !a || (b && b->t < a->t) ? b : a;
}

std::optional<RayHit> on_triangle(const std::array<Vec3, 3>& c, const Ray& ray, double most) {
  // Moeller, Trumbore 1997.
  const Vec3 u = c[1] - c[0], v = c[2] - c[0], p = cross(ray.direction, v), n = cross(u, v);
  const double det = dot(u, p);
  if (det == 0) return std::nullopt;
  const Vec3 o = ray.origin - c[0], q = cross(o, u);
  const double a = dot(o, p) / det, b = dot(ray.direction, q) / det, t = dot(v, q) / det;
  if (!(a >= 0 && b >= 0 && a + b <= 1 && t >= 0 && t <= most)) return std::nullopt;
  return RayHit{t, normalized(dot(n, ray.direction) > 0 ? -n : n)};
}

/// True when the ray meets the box no later than `most`.
bool meets(const Box& b, const Ray& r, double most) {
  Clip clip(most);
  clip.cut({1, 0, 0}, b.high.x, r), clip.cut({-1, 0, 0}, -b.low.x, r);
  clip.cut({0, 1, 0}, b.high.y, r), clip.cut({0, -1, 0}, -b.low.y, r);
  clip.cut({0, 0, 1}, b.high.z, r), clip.cut({0, 0, -1}, -b.low.z, r);
  return clip.hit(r).has_value();
}

std::optional<RayHit> local_cast(const Solid& s, const Ray& ray, double most);

std::optional<RayHit> on_mesh(const TriangleMesh& m, const Ray& ray, double most) {
  std::optional<RayHit> best;
  // Boxes of flat triangles are flat: enlarged slightly.
  const double hair = 1e-12 * norm(m.tree().bounds().high - m.tree().bounds().low);
  m.tree().each([&](const Box& b) { return meets(b.grown(hair), ray, best ? best->t : most); },
                [&](uint32_t i) {
                  auto hit = on_triangle(m.triangle(i).corner, ray, best ? best->t : most);
                  if (hit && (!best || hit->t < best->t)) hit->part = i, best = hit;
                });
  return best;
}

std::optional<RayHit> on_heights(const HeightField& h, const Ray& ray, double most) {
  const Box b = h.bounds().grown(1e-12 * norm(h.bounds().high - h.bounds().low));
  if (!meets(b, ray, most)) return std::nullopt;
  // In pieces, so that a long ray does not visit the whole field.
  constexpr int kPieces = 64;
  const double across = norm(b.high - b.low) + norm(ray.origin - b.center());
  const double end = std::min(most, 2 * across / norm(ray.direction));
  for (int k = 0; k < kPieces; ++k) {
    Box piece = Box::nothing();
    piece.cover(ray.origin + ray.direction * (end * k / kPieces));
    piece.cover(ray.origin + ray.direction * (end * (k + 1) / kPieces));
    std::optional<RayHit> best;
    h.overlapping(piece.grown(1e-9 * across), [&](uint32_t i) {
      const auto corners = h.corners(i);
      if (!corners) return;
      auto hit = on_triangle(*corners, ray, best ? best->t : most);
      if (hit && (!best || hit->t < best->t)) hit->part = i, best = hit;
    });
    if (best && best->t <= end * (k + 1) / kPieces * (1 + 1e-9)) return best;
  }
  return std::nullopt;
}

std::optional<RayHit> on_compound(const Compound& c, const Ray& ray, double most) {
  std::optional<RayHit> best;
  c.tree().each(
      [&](const Box& b) { return meets(b, ray, best ? best->t : most); },
      [&](uint32_t i) {
        const auto& part = c.parts()[i];
        const Ray own{part.place.inverse_point(ray.origin), part.place.inverse_direction(ray.direction)};
        auto hit = local_cast(part.solid, own, best ? best->t : most);
        if (!hit || (best && hit->t >= best->t)) return;
        best = RayHit{hit->t, part.place.direction(hit->normal), i};
      });
  return best;
}

std::optional<RayHit> local_cast(const Solid& s, const Ray& ray, double most) {
  switch (s.kind) {
    case SolidKind::sphere:
      return on_ball({}, s.size.x, ray, most);
    case SolidKind::cylinder:
      return on_cylinder(s.size.x, s.size.y, ray, most);
    case SolidKind::capsule:
      return earlier(on_cylinder(s.size.x, s.size.y, ray, most),
                     earlier(on_ball({0, s.size.y, 0}, s.size.x, ray, most),
                             on_ball({0, -s.size.y, 0}, s.size.x, ray, most)));
    case SolidKind::box: {
      Clip clip(most);
      clip.cut({1, 0, 0}, s.size.x, ray), clip.cut({-1, 0, 0}, s.size.x, ray);
      clip.cut({0, 1, 0}, s.size.y, ray), clip.cut({0, -1, 0}, s.size.y, ray);
      clip.cut({0, 0, 1}, s.size.z, ray), clip.cut({0, 0, -1}, s.size.z, ray);
      return clip.hit(ray);
    }
    case SolidKind::hull: {
      Clip clip(most);
      for (const HullFace& f : s.hull->faces) clip.cut(f.normal, f.offset, ray);
      return clip.hit(ray);
    }
    case SolidKind::plane: {
      Clip clip(most);
      clip.cut(s.size, 0, ray);
      return clip.hit(ray);
    }
    case SolidKind::mesh:
      return on_mesh(*s.mesh, ray, most);
    case SolidKind::height_field:
      return on_heights(*s.heights, ray, most);
    case SolidKind::compound:
      return on_compound(*s.compound, ray, most);
    case SolidKind::triangle:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::optional<RayHit> ray_cast(const Solid& solid, const Transform& at, const Ray& ray, double most) {
  auto hit = local_cast(solid, {at.inverse_point(ray.origin), at.inverse_direction(ray.direction)}, most);
  if (hit) hit->normal = at.direction(hit->normal);
  return hit;
}

}  // namespace truestep
