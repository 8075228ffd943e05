// Axis-aligned box: the set low <= p <= high.
#pragma once
#include <limits>

#include "engine/math/vec3.h"

namespace truestep {

struct Box {
  Vec3 low, high;

  void cover(const Vec3& p) {
    low = {p.x < low.x ? p.x : low.x, p.y < low.y ? p.y : low.y, p.z < low.z ? p.z : low.z};
    high = {p.x > high.x ? p.x : high.x, p.y > high.y ? p.y : high.y, p.z > high.z ? p.z : high.z};
  }
  void cover(const Box& b) {
    cover(b.low);
    cover(b.high);
  }
  bool overlaps(const Box& b) const {
    return (low.x <= b.high.x) & (low.y <= b.high.y) & (low.z <= b.high.z) & (b.low.x <= high.x) &
           (b.low.y <= high.y) & (b.low.z <= high.z);
  }
  bool contains(const Box& b) const {
    return (low.x <= b.low.x) & (low.y <= b.low.y) & (low.z <= b.low.z) & (b.high.x <= high.x) &
           (b.high.y <= high.y) & (b.high.z <= high.z);
  }
  /// The box with every face `by` (m) further out.
  Box grown(double by) const {
    return {{low.x - by, low.y - by, low.z - by}, {high.x + by, high.y + by, high.z + by}};
  }
  Vec3 center() const { return (low + high) * 0.5; }
  bool finite() const {
    return std::isfinite(low.x) && std::isfinite(low.y) && std::isfinite(low.z) && std::isfinite(high.x) &&
           std::isfinite(high.y) && std::isfinite(high.z);
  }
  /// The empty box; extending it by something gives that thing's box.
  static Box nothing() {
    constexpr double kHuge = std::numeric_limits<double>::infinity();
    return {{kHuge, kHuge, kHuge}, {-kHuge, -kHuge, -kHuge}};
  }
};

}  // namespace truestep
