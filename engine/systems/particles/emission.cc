#include "engine/systems/particles/emission.h"

#include "engine/base/random.h"
#include "engine/systems/particles/sampling.h"

namespace truestep::particles {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

Vec3 place(const EmitterDef& e, const Vec3& axis, const std::array<double, 4>& u) {
  switch (e.shape) {
    case EmitterDef::Shape::point:
      return e.position;
    case EmitterDef::Shape::disk:
      return e.position + point_in_disk(axis, u[0], u[1]) * e.radius;
    case EmitterDef::Shape::box:
      return e.position + Vec3{e.half_extents.x * (2 * u[0] - 1), e.half_extents.y * (2 * u[1] - 1),
                               e.half_extents.z * (2 * u[2] - 1)};
    case EmitterDef::Shape::sphere:
      return e.position + point_in_ball(u) * e.radius;
    case EmitterDef::Shape::line:
      break;
  }
  return e.position + (e.end - e.position) * u[0];
}

}  // namespace

double birth_time(const EmitterDef& e, uint64_t n) {
  // The table allows bursts or a rate, not both.
  const uint64_t in_bursts = e.bursts.size() * static_cast<uint64_t>(e.burst_count);
  if (in_bursts > 0) return n < in_bursts ? e.bursts[n / static_cast<uint64_t>(e.burst_count)] : kNever;
  if (!(e.rate > 0)) return kNever;
  const double t = e.start + static_cast<double>(n) / e.rate;
  return e.stop && t >= *e.stop ? kNever : t;
}

Birth birth(const EmitterDef& e, uint64_t seed, uint64_t emitter, uint64_t n) {
  const auto where = uniform4(seed, 2 * emitter, n), how = uniform4(seed, 2 * emitter + 1, n);
  const Vec3 axis = normalized(e.direction, {0, 1, 0});
  Birth b;
  b.x = place(e, axis, where);
  b.v = direction_in_cone(axis, e.cone, how[0], how[1]) * (e.speed + e.speed_spread * (2 * how[2] - 1));
  b.lifetime = e.lifetime ? *e.lifetime + e.lifetime_spread * (2 * how[3] - 1) : kNever;
  return b;
}

}  // namespace truestep::particles
