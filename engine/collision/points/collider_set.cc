#include "engine/collision/points/collider_set.h"

#include <array>
#include <limits>

#include "engine/base/errors.h"
#include "engine/collision/points/point_contact.h"

namespace truestep {
namespace {

/// Rows per group, whose common box is tested before any row.
constexpr size_t kGroup = 64;

/// Box around both ends of rows [begin, end). Lanes hold x y z x y z ..., so that the loop is flat.
void group_bounds(const double* a, const double* b, size_t begin, size_t end, Vec3& low, Vec3& high) {
  constexpr double kHuge = std::numeric_limits<double>::infinity();
  double lo[12], hi[12];
  for (int k = 0; k < 12; ++k) lo[k] = kHuge, hi[k] = -kHuge;
  size_t i = 3 * begin;
  for (; i + 12 <= 3 * end; i += 12) {
    for (int k = 0; k < 12; ++k) {
      const double p = a[i + k], q = b[i + k];
      const double small = p < q ? p : q, large = p < q ? q : p;
      lo[k] = small < lo[k] ? small : lo[k];
      hi[k] = large > hi[k] ? large : hi[k];
    }
  }
  for (; i < 3 * end; ++i) {
    const size_t k = (i - 3 * begin) % 3;
    lo[k] = std::min({lo[k], a[i], b[i]});
    hi[k] = std::max({hi[k], a[i], b[i]});
  }
  low = {std::min({lo[0], lo[3], lo[6], lo[9]}), std::min({lo[1], lo[4], lo[7], lo[10]}),
         std::min({lo[2], lo[5], lo[8], lo[11]})};
  high = {std::max({hi[0], hi[3], hi[6], hi[9]}), std::max({hi[1], hi[4], hi[7], hi[10]}),
          std::max({hi[2], hi[5], hi[8], hi[11]})};
}

/// True when no point that stays in the box can touch.
bool box_clear_of(const SweptCollider& c, const Vec3& low, const Vec3& high) {
  if (c.shape.kind == ShapeKind::plane) {
    const Vec3& n = c.end_normal;
    const double least = n.x * (n.x > 0 ? low.x : high.x) + n.y * (n.y > 0 ? low.y : high.y) +
                         n.z * (n.z > 0 ? low.z : high.z);
    return least > c.end_level;
  }
  if (c.shape.side == PointSide::inside) {
    return low.x >= c.safe_low.x && low.y >= c.safe_low.y && low.z >= c.safe_low.z &&
           high.x <= c.safe_high.x && high.y <= c.safe_high.y && high.z <= c.safe_high.z;
  }
  return high.x < c.low.x || high.y < c.low.y || high.z < c.low.z || low.x > c.high.x || low.y > c.high.y ||
         low.z > c.high.z;
}

/// A group's paths by axis, so that tests against a solid are flat loops: smaller and larger end, end of the
/// step, and the clearance left before anything can be touched (a bound; at most 0 means look closer).
struct GroupPaths {
  alignas(64) double small[3][kGroup], large[3][kGroup], end[3][kGroup], room[kGroup];

  void load(const double* a, const double* b, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      for (size_t k = 0; k < 3; ++k) {
        const double p = a[3 * i + k], q = b[3 * i + k];
        small[k][i] = p < q ? p : q;
        large[k][i] = p < q ? q : p;
        end[k][i] = q;
      }
      room[i] = std::numeric_limits<double>::infinity();
    }
  }
  // Loops run over the whole group: results beyond `count` are ignored.
  void against_plane(const SweptCollider& c) {
    const Vec3 n = c.end_normal;
    for (size_t i = 0; i < kGroup; ++i) {
      const double d = n.x * end[0][i] + n.y * end[1][i] + n.z * end[2][i] - c.end_level;
      room[i] = d < room[i] ? d : room[i];
    }
  }
  void against_solid(const SweptCollider& c) {
    const double low[3] = {c.low.x, c.low.y, c.low.z}, high[3] = {c.high.x, c.high.y, c.high.z};
    for (size_t i = 0; i < kGroup; ++i) {
      double apart = low[0] - large[0][i];
      for (size_t k = 0; k < 3; ++k) {
        const double below = low[k] - large[k][i], above = small[k][i] - high[k];
        apart = below > apart ? below : apart;
        apart = above > apart ? above : apart;
      }
      room[i] = apart < room[i] ? apart : room[i];
    }
  }
  void against_container(const SweptCollider& c) {
    const double low[3] = {c.safe_low.x, c.safe_low.y, c.safe_low.z};
    const double high[3] = {c.safe_high.x, c.safe_high.y, c.safe_high.z};
    for (size_t i = 0; i < kGroup; ++i) {
      double inside = end[0][i] - low[0];
      for (size_t k = 0; k < 3; ++k) {
        const double from_low = end[k][i] - low[k], to_high = high[k] - end[k][i];
        inside = from_low < inside ? from_low : inside;
        inside = to_high < inside ? to_high : inside;
      }
      room[i] = inside < room[i] ? inside : room[i];
    }
  }
  void against(const SweptCollider& c) {
    if (c.shape.kind == ShapeKind::plane) return against_plane(c);
    return c.shape.side == PointSide::inside ? against_container(c) : against_solid(c);
  }
};

}  // namespace

void ColliderSet::add(Collider c) {
  if (colliders_.size() == kMaxColliders) {
    throw Error("too_many_colliders", "a system has more than 256 colliders");
  }
  colliders_.push_back(std::move(c));
}

void ColliderSet::resolve(const ContactSweep& sweep, Workspace& workspace, const ThreadArena& arena) const {
  if (colliders_.empty() || sweep.x.empty()) return;
  auto& swept = workspace.object<std::vector<SweptCollider>>("collision.swept");
  swept.clear();
  for (size_t k = 0; k < colliders_.size(); ++k) {
    const Surface& surface = sweep.surfaces.empty() ? colliders_[k].surface : sweep.surfaces[k];
    swept.push_back(sweep_collider(colliders_[k], surface, sweep.t, sweep.h, sweep.radius));
  }

  const double h = sweep.h;
  arena.for_blocks(sweep.x.size() / 3, kBlockRows, [&](size_t begin, size_t end) {
    std::array<uint16_t, kMaxColliders> near_group;
    GroupPaths paths{};
    for (size_t group = begin; group < end; group += kGroup) {
      const size_t stop = std::min(end, group + kGroup);
      Vec3 low, high;
      group_bounds(sweep.x_old.data(), sweep.x.data(), group, stop, low, high);
      size_t count = 0;
      for (size_t k = 0; k < swept.size(); ++k) {
        if (!box_clear_of(swept[k], low, high)) near_group[count++] = static_cast<uint16_t>(k);
      }
      if (count == 0) continue;
      paths.load(&sweep.x_old[3 * group], &sweep.x[3 * group], stop - group);
      for (size_t k = 0; k < count; ++k) paths.against(swept[near_group[k]]);
      for (size_t i = group; i < stop; ++i) {
        if (paths.room[i - group] > 0) continue;
        if (!sweep.inverse_mass.empty() && sweep.inverse_mass[i] == 0) continue;
        const Vec3 x0 = load3(sweep.x_old.data(), i), x1 = load3(sweep.x.data(), i);
        bool touches = false;
        for (size_t k = 0; k < count && !touches; ++k) touches = !clear_of(swept[near_group[k]], x0, x1);
        if (!touches) continue;
        const Vec3 v0 = load3(sweep.v_old.data(), i), v1 = load3(sweep.v.data(), i), dv = v1 - v0;
        const Vec3 start = (x1 - x0) / h - dv * 0.5;
        const PointEnd out = advance_point(swept, {x0, start, dv / h, 0}, v0, v1 - (start + dv), h);
        store3(sweep.x.data(), i, out.x);
        store3(sweep.v.data(), i, out.v);
      }
    }
  });
}

double ColliderSet::clearance(const Vec3& x, double t) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Collider& c : colliders_) {
    const Pose pose = moved(c.start, c.motion, t);
    const Vec3 p = rotation(pose.orientation).apply_inverse(x - pose.position);
    const double d = solid_distance(c.shape, p).d;
    least = std::min(least, c.shape.side == PointSide::outside ? d : -d);
  }
  return least;
}

std::optional<NearSurface> ColliderSet::surface_of(size_t k, const Vec3& x, double t, double limit) const {
  const Collider& c = colliders_[k];
  const Pose pose = moved(c.start, c.motion, t);
  const Rotation r = rotation(pose.orientation);
  const SurfaceDistance<double> local = solid_distance(c.shape, r.apply_inverse(x - pose.position));
  const double side = c.shape.side == PointSide::outside ? 1 : -1, distance = side * local.d;
  if (distance >= limit) return std::nullopt;
  NearSurface out{.collider = k, .distance = distance, .normal = r.apply(local.n) * side, .velocity = {}};
  if (c.motion.at_rest()) return out;
  const SweptCollider swept = sweep_collider(c, c.surface, t, 1e-4, 0);
  out.velocity = swept.velocity + cross(swept.spin, x - pose.position);
  return out;
}

NearSurface ColliderSet::nearest(const Vec3& x, double t) const {
  NearSurface out;
  double least = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < colliders_.size(); ++k) {
    const auto s = surface_of(k, x, t, least);
    if (s) out = *s, least = s->distance;
  }
  return out;
}

std::vector<DrawnShape> ColliderSet::drawn(double t) const {
  static constexpr DrawnShape::Kind kKinds[] = {DrawnShape::Kind::plane, DrawnShape::Kind::box,
                                                DrawnShape::Kind::sphere, DrawnShape::Kind::capsule};
  std::vector<DrawnShape> out;
  for (const Collider& c : colliders_) {
    const Pose pose = moved(c.start, c.motion, t);
    const Quat& q = pose.orientation;
    out.push_back({kKinds[static_cast<size_t>(c.shape.kind)],
                   pose.position,
                   {q.w, q.x, q.y, q.z},
                   c.shape.size,
                   c.id,
                   c.shape.side == PointSide::inside});
  }
  return out;
}

}  // namespace truestep
