#include "engine/systems/sph/inlet.h"

namespace truestep::sph {

Inlet::Inlet(const SphDef& d, const InletDef& e)
    : mouth(e.position),
      along(normalized(e.direction, {0, 1, 0})),
      radius(e.radius),
      reach(e.radius + 0.25 * d.spacing),
      depth(d.support * d.spacing),
      speed(e.speed),
      ratio(e.density.value_or(d.density) / d.density),
      start(e.start),
      stop(e.stop.value_or(std::numeric_limits<double>::infinity())),
      pause(d.spacing / e.speed) {
  const bool plane = d.dimension == 2;
  if (plane) mouth.z = 0;
  // Two directions across the axis; in the plane one.
  const Vec3 up = std::abs(along.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 u = normalized(cross(up, along), {1, 0, 0}), w = cross(along, u);
  // The definition's check comes here with any radius: it may not ask for more than the box can hold.
  const double widest = norm(d.high - d.low) / d.spacing;
  const double across = std::floor(std::min(2 * radius / d.spacing, widest) + 0.5);
  const auto count = static_cast<int64_t>(across);
  for (int64_t i = 0; i < count; ++i) {
    for (int64_t j = 0; j < (plane ? 1 : count); ++j) {
      const auto at = [&](int64_t m) { return (static_cast<double>(m) + 0.5 - across / 2) * d.spacing; };
      const Vec3 p = u * at(i) + (plane ? Vec3{} : w * at(j));
      if (norm2(p) <= radius * radius) places.push_back(p);
    }
  }
}

}  // namespace truestep::sph
