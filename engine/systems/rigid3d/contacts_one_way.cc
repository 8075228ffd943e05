// Contacts with bodies that are solid from one side only (one_way), as in the plane (rigid2d/pairs.cc).
#include <algorithm>

#include "engine/rigid/one_way.h"
#include "engine/systems/rigid3d/contacts.h"

namespace truestep::rigid3d {
namespace {

/// Whether the two touched at the end of the last step; rows ascend by the pairs of bodies.
bool touched(const State& s, const BodyPair& pair) {
  const auto bodies = s.span<uint32_t>(columns::contact_bodies);
  const auto key = [&](size_t row) { return uint64_t{bodies[2 * row]} << 32 | bodies[2 * row + 1]; };
  const uint64_t wanted = uint64_t{pair.a} << 32 | pair.b;
  size_t low = 0, high = s.rows(columns::contact_bodies);
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (key(middle) < wanted) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low < s.rows(columns::contact_bodies) && key(low) == wanted;
}

}  // namespace

bool ContactList::passes(const State& s, std::span<const BodyKind> kinds, const BodyPair& pair,
                         const Manifold& found, double margin) const {
  if (touched(s, pair)) return false;
  const auto kind = s.span<uint32_t>(columns::kind);
  const double* v = s.f64(columns::velocity).data();
  const auto through = [&](uint32_t platform, uint32_t other, const Vec3& n) {
    const BodyKind& k = kinds[kind[platform]];
    if (!k.one_way) return false;
    const Vec3 up = bodies_[platform].at.direction(k.one_way_direction);
    return !one_way_holds(dot(n, up), dot(load3(v, other) - load3(v, platform), up)) ||
           found.deepest() > margin;
  };
  return through(pair.a, pair.b, found.normal) || through(pair.b, pair.a, -found.normal);
}

}  // namespace truestep::rigid3d
