#include "engine/collision/points/nozzle.h"

#include "engine/base/parallel.h"

namespace truestep {

Nozzle::Nozzle(const SourceDef& e, const Sizes& d)
    : mouth(e.position),
      along(normalized(e.direction, {0, 1, 0})),
      radius(e.radius),
      reach(e.radius + 0.25 * d.spacing),
      depth(d.depth),
      speed(e.speed),
      start(e.start),
      stop(e.stop.value_or(std::numeric_limits<double>::infinity())),
      pause(d.spacing / e.speed) {
  const bool plane = d.dimension == 2;
  if (plane) mouth.z = 0;
  // Two directions perpendicular to the axis; one in the plane.
  const Vec3 up = std::abs(along.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 u = normalized(cross(up, along), {1, 0, 0}), w = cross(along, u);
  const double across = std::floor(std::min(2 * radius, d.widest) / d.spacing + 0.5);
  const auto count = static_cast<int64_t>(across);
  for (int64_t i = 0; i < count; ++i) {
    for (int64_t j = 0; j < (plane ? 1 : count); ++j) {
      const auto at = [&](int64_t m) { return (static_cast<double>(m) + 0.5 - across / 2) * d.spacing; };
      const Vec3 p = u * at(i) + (plane ? Vec3{} : w * at(j));
      if (norm2(p) <= radius * radius) places.push_back(p);
    }
  }
}

uint64_t find_killed(const KillDefs& regions, const State& s, State::Column position,
                     const ThreadArena& arena, std::vector<uint8_t>& dead) {
  const size_t n = s.rows(position);
  dead.assign(n, 0);
  const RealColumn<const double> x(s, position);
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    flag_killed(
        regions, begin, end, [&](size_t i) { return x.vector(i); }, dead.data());
  });
  return static_cast<uint64_t>(std::count(dead.begin(), dead.end(), 1));
}

}  // namespace truestep
