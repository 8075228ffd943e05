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

/// The ground of a contact with one.
Touched touched_ground(const Contact& c, std::span<const BodyKind> kinds, std::span<const uint32_t> kind,
                       std::span<const BodyNow> now) {
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
  return {kinds[kind[ground]].solid, now[ground].at, ground_a ? m.part_a : m.part_b, n,
          ground_a ? point : point - c.apart};
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

void ContactList::look_at_seams_now(const State& s, std::span<const BodyKind> kinds) {
  const auto kind = s.span<uint32_t>(columns::kind);
  pieces_.assign(kind.size(), 0);
  const auto on = [&](const BodyPair& p) -> uint8_t* {
    const bool ground_a = is_ground(kinds[kind[p.a]]), ground_b = is_ground(kinds[kind[p.b]]);
    return ground_a == ground_b ? nullptr : &pieces_[ground_a ? p.b : p.a];
  };
  for (const BodyPair& p : pairs_) {
    if (uint8_t* n = on(p); n && *n < 2) ++*n;
  }
  for (size_t k = 0; k < pairs_.size(); ++k) {
    if (const uint8_t* n = on(pairs_[k]); n && *n > 1) bears_[k] = 0;
  }
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
  for (size_t first = 0, last = 0; first < on_ground_.size(); first = last) {
    while (last < on_ground_.size() && on_ground_[last].first == on_ground_[first].first) ++last;
    if (last - first < 2) continue;
    const double margin = bodies_[on_ground_[first].first].margin;
    floors_.clear();
    const auto touched = [&](size_t k) {
      return touched_ground(*contacts_[on_ground_[k].second], kinds, kind, bodies_);
    };
    for (size_t k = first; k < last; ++k) {
      const Touched ground = touched(k);
      if (const auto up = floor_normal(ground)) floors_.push_back({{ground, *up}, k});
    }
    // What lies beside a floor makes it wider.
    bool wider = !floors_.empty();
    while (wider) {
      wider = false;
      for (size_t k = first; k < last; ++k) {
        Contact*& c = contacts_[on_ground_[k].second];
        if (!c) continue;
        const Touched beside = touched(k);
        const auto floor = std::find_if(floors_.begin(), floors_.end(), [&](const auto& f) {
          return f.second != k && seam(beside, f.first, kFlush * margin, margin) != Seam::none;
        });
        if (floor == floors_.end()) continue;
        const Vec3 up = floor->first.up;
        if (seam(beside, floor->first, kFlush * margin, margin) == Seam::goes_on) {
          c->manifold.normal = dot(c->manifold.normal, up) > 0 ? up : -up;
          continue;
        }
        seams_.push_back(uint64_t{c->a} << 32 | c->b);
        c = nullptr, wider = true;
        floors_.push_back({{beside, up}, k});
      }
    }
  }
  if (seams_.empty()) return;
  std::erase(contacts_, nullptr);
  std::sort(seams_.begin(), seams_.end());
}

bool ContactList::meets_seam(const State& s, std::span<const BodyKind> kinds, uint32_t i, uint32_t j,
                             const Impact& hit) const {
  const auto kind = s.span<uint32_t>(columns::kind);
  if (!seams_possible_ || !is_ground(kinds[kind[j]])) return false;
  const Touched beside{kinds[kind[j]].solid, bodies_[j].at, hit.part_b, -hit.normal, hit.point};
  const double margin = bodies_[i].margin;
  return std::any_of(contacts_.begin(), contacts_.end(), [&](const Contact* c) {
    if (c->a != i && c->b != i) return false;
    const uint32_t other = c->a == i ? c->b : c->a;
    if (other == j || !is_ground(kinds[kind[other]])) return false;
    const Touched ground = touched_ground(*c, kinds, kind, bodies_);
    const auto up = floor_normal(ground);
    return up && seam(beside, Floor{ground, *up}, kFlush * margin, margin) != Seam::none;
  });
}

}  // namespace truestep::rigid3d
