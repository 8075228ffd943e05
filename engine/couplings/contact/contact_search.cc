#include "engine/couplings/contact/contact_search.h"

#include <algorithm>
#include <cmath>

namespace truestep::contact {

namespace {

/// Box around the rest of a row's path: both ends, and an eighth of the bend on every side.
Box box_of_path(const MovingPoints& p, size_t row, double h) {
  const Vec3 a = p.from(row), b = load3(p.x, row), bend = p.acceleration(row, h) * (0.125 * h * h);
  const auto low = [](double u, double v, double w) { return (u < v ? u : v) - std::fabs(w); };
  const auto high = [](double u, double v, double w) { return (u < v ? v : u) + std::fabs(w); };
  return {{low(a.x, b.x, bend.x), low(a.y, b.y, bend.y), low(a.z, b.z, bend.z)},
          {high(a.x, b.x, bend.x), high(a.y, b.y, bend.y), high(a.z, b.z, bend.z)}};
}

Box box_of_solid(const ContactQuery& q, size_t solid) {
  const SolidList::Corners c = q.solids.corners(solid);
  Box box = box_of_path(q.other, c.rows[0], q.h);
  for (size_t k = 1; k < c.count; ++k) box.cover(box_of_path(q.other, c.rows[k], q.h));
  const Vec3 pad{q.reach, q.reach, q.reach};
  return {box.low - pad, box.high + pad};
}

bool touched_in(const ContactQuery& q, size_t solid, uint32_t round) {
  const SolidList::Corners c = q.solids.corners(solid);
  for (size_t k = 0; k < c.count; ++k) {
    if (q.other.traces.touched_in(c.rows[k], round)) return true;
  }
  return false;
}

}  // namespace

void PointMemory::store(const ConstPoints& start) {
  x_.assign(start.x, start.x + 3 * start.count);
  v_.assign(start.v, start.v + 3 * start.count);
  ids_.assign(start.ids.begin(), start.ids.end());
}

void PointMemory::follow(const ConstPoints& end, double h) {
  align(end);
  add_split(end, h);
  free_v_.assign(end.v, end.v + 3 * end.count);
}

void PointMemory::align(const ConstPoints& now) {
  if (std::equal(ids_.begin(), ids_.end(), now.ids.begin(), now.ids.end())) return;
  // Ids ascend in both lists; remaining rows keep their order, so reading stays ahead of writing.
  const size_t stored = ids_.size();
  size_t from = 0, kept = 0;
  for (size_t row = 0; row < now.count && from < stored; ++row) {
    while (from < stored && ids_[from] < now.ids[row]) ++from;
    if (from == stored || ids_[from] != now.ids[row]) break;
    store3(x_.data(), row, load3(x_.data(), from));
    store3(v_.data(), row, load3(v_.data(), from));
    kept = row + 1;
  }
  x_.resize(3 * now.count);
  v_.resize(3 * now.count);
  std::copy(now.x + 3 * kept, now.x + 3 * now.count, x_.begin() + static_cast<std::ptrdiff_t>(3 * kept));
  std::copy(now.v + 3 * kept, now.v + 3 * now.count, v_.begin() + static_cast<std::ptrdiff_t>(3 * kept));
  ids_.assign(now.ids.begin(), now.ids.end());
}

void PointMemory::add_split(const ConstPoints& now, double h) {
  for (size_t row = x_.size() / 3; row < now.count; ++row) {
    const Vec3 v = load3(now.v, row), x = load3(now.x, row) - v * h;
    x_.insert(x_.end(), {x.x, x.y, x.z});
    v_.insert(v_.end(), {v.x, v.y, v.z});
  }
}

const std::vector<Touch>& ContactSearch::run(const ContactQuery& q, uint32_t round,
                                             const ThreadArena& arena) {
  corners_.resize(q.other_count);
  arena.for_blocks(corners_.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      if (round == 0 || q.other.traces.touched_in(row, round - 1)) corners_[row] = q.other.path(row, q.h);
    }
  });
  if (round == 0) {
    look_at_all(q, arena);
  } else {
    look_at_changes(q, round - 1, arena);
  }
  touches_.clear();
  for (const auto& found : found_) touches_.insert(touches_.end(), found.begin(), found.end());
  std::sort(touches_.begin(), touches_.end(), touch_order);
  return touches_;
}

// For two balls of one system only one order counts.
void ContactSearch::find_pairs(const ContactQuery& q, const ThreadArena& arena) {
  if (q.own == OwnSolids::yes) {
    near_.find(arena,
               [&](uint32_t point, uint32_t solid) { return q.solids.corners(solid).rows[0] > point; });
  } else {
    near_.find(arena, [](uint32_t, uint32_t) { return true; });
  }
  found_.resize(near_.blocks());
}

void ContactSearch::look_at_all(const ContactQuery& q, const ThreadArena& arena) {
  near_.points.resize(q.count);
  arena.for_blocks(q.count, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) near_.points[i] = box_of_path(q.points, i, q.h);
  });
  near_.solids.resize(q.solids.size());
  arena.for_blocks(near_.solids.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) near_.solids[i] = box_of_solid(q, i);
  });
  find_pairs(q, arena);
  look_at_pairs(q, arena, [](const NearPair&) { return true; });
}

void ContactSearch::look_at_changes(const ContactQuery& q, uint32_t last, const ThreadArena& arena) {
  bool held = true;
  for (size_t i = 0; i < q.count; ++i) {
    if (q.points.traces.touched_in(i, last)) held &= near_.holds_point(i, box_of_path(q.points, i, q.h));
  }
  changed_.resize(q.solids.size());
  for (size_t i = 0; i < changed_.size(); ++i) {
    changed_[i] = touched_in(q, i, last);
    if (changed_[i]) held &= near_.holds_solid(i, box_of_solid(q, i));
  }
  if (!held) find_pairs(q, arena);
  look_at_pairs(q, arena, [&](const NearPair& pair) {
    return changed_[pair.solid] || q.points.traces.touched_in(pair.point, last);
  });
}

template <class Due>
void ContactSearch::look_at_pairs(const ContactQuery& q, const ThreadArena& arena, Due&& due) {
  near_.each_block(arena, [&](size_t block, const std::vector<NearPair>& pairs) {
    std::vector<Touch>& found = found_[block];
    found.clear();
    HullPath path;
    uint32_t point = ~uint32_t{0};
    std::array<HullPath, 3> corners;
    for (const NearPair& pair : pairs) {
      if (!due(pair)) continue;
      // Pairs are sorted by point.
      if (pair.point != point) path = q.points.path(point = pair.point, q.h);
      const SolidList::Corners c = q.solids.corners(pair.solid);
      double start = q.points.traces.since(point);
      for (size_t k = 0; k < c.count; ++k) {
        corners[k] = corners_[c.rows[k]];
        start = std::max(start, q.other.traces.since(c.rows[k]));
      }
      if (c.count == 3 && stays_clear(path, corners, 1.01 * q.reach, start)) continue;
      const auto hit = first_hull_contact(path, corners, c.count, q.reach, start);
      if (hit) found.push_back({hit->s, pair.point, pair.solid});
    }
  });
}

std::optional<HullContact> touch_of(const ContactQuery& q, const Touch& t) {
  const SolidList::Corners c = q.solids.corners(t.solid);
  std::array<HullPath, 3> corners;
  double start = q.points.traces.since(t.point);
  for (size_t k = 0; k < c.count; ++k) {
    corners[k] = q.other.path(c.rows[k], q.h);
    start = std::max(start, q.other.traces.since(c.rows[k]));
  }
  return first_hull_contact(q.points.path(t.point, q.h), corners, c.count, q.reach, start);
}

}  // namespace truestep::contact
