// Goal positions of the points of a group; sums are taken in the order of the points.
#pragma once
#include "engine/kernels/xpbd/shape_match.h"
#include "engine/systems/xpbd/matching/match_set.h"

namespace truestep::xpbd {

template <class Place>
std::pair<Vec3, Mat3> MatchSet::goal(size_t group, const Place& x) const {
  Vec3 centre;
  double mass = 0;
  for (uint32_t e = begin[group]; e < begin[group + 1]; ++e) {
    centre += x(points[e]) * masses[e], mass += masses[e];
  }
  centre = centre / mass;
  Mat3 apq;
  for (uint32_t e = begin[group]; e < begin[group + 1]; ++e) {
    const Vec3 d = (x(points[e]) - centre) * masses[e], &q = rest[e];
    apq.m[0] += d.x * q.x, apq.m[1] += d.x * q.y, apq.m[2] += d.x * q.z;
    apq.m[3] += d.y * q.x, apq.m[4] += d.y * q.y, apq.m[5] += d.y * q.z;
    apq.m[6] += d.z * q.x, apq.m[7] += d.z * q.y, apq.m[8] += d.z * q.z;
  }
  return {centre, match_transform(apq, inverse[group], linear)};
}

}  // namespace truestep::xpbd
