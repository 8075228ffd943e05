// Positions and motions of links in the world, from frames of the tree.
#pragma once
#include <algorithm>

#include "engine/core/ports/body_access.h"
#include "engine/systems/articulation/tree.h"

namespace truestep::articulation {

/// Quaternion of a proper rotation matrix (Shepperd 1978): the largest of the four numbers by a root, the
/// rest by quotients.
inline Quat quaternion(const Rotation& r) {
  const double xx = r.row[0].x, yy = r.row[1].y, zz = r.row[2].z, trace = xx + yy + zz;
  const Vec3 odd{r.row[2].y - r.row[1].z, r.row[0].z - r.row[2].x, r.row[1].x - r.row[0].y};
  const double xy = r.row[0].y + r.row[1].x, xz = r.row[0].z + r.row[2].x, yz = r.row[1].z + r.row[2].y;
  if (trace > std::max({xx, yy, zz})) return normalized(Quat{1 + trace, odd.x, odd.y, odd.z});
  if (xx > std::max(yy, zz)) return normalized(Quat{odd.x, 1 + xx - yy - zz, xy, xz});
  if (yy > zz) return normalized(Quat{odd.y, xy, 1 + yy - zz - xx, yz});
  return normalized(Quat{odd.z, xz, yz, 1 + zz - xx - yy});
}

/// Motion of the point `center` (m, in the node's frame) of a node with frame `at` that moves with v there.
inline BodyMotion motion_of(const spatial::Frame& at, const Quat& turn, const spatial::Motion& v,
                            const Vec3& center) {
  return {at.R.apply(center) + at.p, turn, at.R.apply(v.v + cross(v.w, center)), at.R.apply(v.w)};
}

/// The same from the nodes between this one and the ground only, without scratch.
BodyMotion link_motion(const Tree& tree, std::span<const double> q, std::span<const double> v, int32_t node,
                       const Vec3& center);

}  // namespace truestep::articulation
