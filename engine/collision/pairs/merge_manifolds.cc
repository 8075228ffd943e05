#include "engine/collision/pairs/merge_manifolds.h"

#include <algorithm>

#include "engine/collision/pairs/face_clip.h"

namespace truestep {

void merge_manifold(const Manifold& m, size_t first, double same, std::vector<Manifold>& all) {
  for (size_t i = first; i < all.size(); ++i) {
    Manifold& old = all[i];
    if (old.part_b != m.part_b || dot(old.normal, m.normal) < 1 - 5e-9) continue;
    PointList both;
    for (int k = 0; k < old.count; ++k) both.point[both.count++] = old.points[k];
    for (int k = 0; k < m.count; ++k) {
      const Vec3& p = m.points[k].position;
      const bool known = std::any_of(both.point, both.point + both.count, [&](const ContactPoint& q) {
        return norm2(q.position - p) < same * same;
      });
      if (!known) both.point[both.count++] = m.points[k];
    }
    keep_best(both.all(), old.normal, old);
    old.part_a = std::min(old.part_a, m.part_a);
    return;
  }
  all.push_back(m);
}

}  // namespace truestep
