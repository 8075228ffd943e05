// Floors of several flush pieces (collision/pairs/seam.h): what stands on one of them does not touch the
// edges of the next, as in the plane (rigid2d/solver/seams.h).
#include <algorithm>

#include "engine/collision/pairs/seam.h"
#include "engine/systems/rigid3d/contacts.h"

namespace truestep::rigid3d {
namespace {

/// Of a body's margin: steps this high count as flush, as in the plane.
constexpr double kFlush = 0.05;

bool is_ground(const BodyKind& k) {
  return k.motion == BodyDef::Motion::fixed && !k.sensor && !k.one_way;
}

}  // namespace

bool has_seams(const BodyList& bodies) {
  std::vector<Box> boxes;
  for (const BodyStart& b : bodies.starts) {
    const BodyKind& k = bodies.kinds[b.kind];
    if (!is_ground(k) || k.solid.kind == SolidKind::plane) continue;
    if (k.solid.kind == SolidKind::compound) return true;
    const double flush = 1e-3 * std::min(k.reach, 1.0);
    boxes.push_back(bounds(k.solid, transform_of(b.pose)).grown(flush));
  }
  std::sort(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) { return a.low.x < b.low.x; });
  for (size_t i = 0; i < boxes.size(); ++i) {
    for (size_t k = i + 1; k < boxes.size() && boxes[k].low.x <= boxes[i].high.x; ++k) {
      if (boxes[i].overlaps(boxes[k])) return true;
    }
  }
  return false;
}

void ContactList::leave_out_seams(const State& s, std::span<const BodyKind> kinds) {
  const auto kind = s.span<uint32_t>(columns::kind);
  on_ground_.clear(), seams_.clear();
  for (uint32_t i = 0; i < contacts_.size(); ++i) {
    const Contact& c = *contacts_[i];
    const bool ground_a = is_ground(kinds[kind[c.a]]), ground_b = is_ground(kinds[kind[c.b]]);
    if (ground_a == ground_b) continue;
    on_ground_.push_back({ground_a ? c.b : c.a, i});
  }
  std::sort(on_ground_.begin(), on_ground_.end());
  const auto touched = [&](uint32_t i) {
    const Contact& c = *contacts_[i];
    const bool ground_a = is_ground(kinds[kind[c.a]]);
    const uint32_t ground = ground_a ? c.a : c.b;
    const Manifold& m = c.manifold;
    // The point of the ground that is nearest to the body.
    int least = 0;
    for (int p = 1; p < m.count; ++p) {
      if (m.points[p].separation < m.points[least].separation) least = p;
    }
    const Vec3 n = ground_a ? m.normal : -m.normal;
    const Vec3 point = m.points[least].position - n * (0.5 * m.points[least].separation);
    return Touched{kinds[kind[ground]].solid, bodies_[ground].at, ground_a ? m.part_a : m.part_b, n,
                   ground_a ? point : point - c.apart};
  };
  for (size_t first = 0, last = 0; first < on_ground_.size(); first = last) {
    while (last < on_ground_.size() && on_ground_[last].first == on_ground_[first].first) ++last;
    if (last - first < 2) continue;
    const double margin = bodies_[on_ground_[first].first].margin;
    for (size_t i = first; i < last; ++i) {
      const Touched beside = touched(on_ground_[i].second);
      for (size_t k = first; k < last; ++k) {
        if (k == i || !contacts_[on_ground_[k].second]) continue;
        if (!is_seam(beside, touched(on_ground_[k].second), kFlush * margin, margin)) continue;
        Contact*& c = contacts_[on_ground_[i].second];
        seams_.push_back(uint64_t{c->a} << 32 | c->b);
        c = nullptr;
        break;
      }
    }
  }
  if (seams_.empty()) return;
  std::erase(contacts_, nullptr);
  std::sort(seams_.begin(), seams_.end());
}

}  // namespace truestep::rigid3d
