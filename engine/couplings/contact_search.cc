#include "engine/couplings/contact_search.h"

#include <algorithm>
#include <cmath>

namespace truestep {

namespace {

/// Points that look for solids together: enough to be worth a task, few enough
/// to balance.
constexpr size_t kBlockPoints = 1024;

/// Box around the rest of a row's way: both ends, and an eighth of the bend to every side.
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

bool touched(const ContactQuery& q, size_t solid) {
  const SolidList::Corners c = q.solids.corners(solid);
  for (size_t k = 0; k < c.count; ++k) {
    if (q.other.traces.touched(c.rows[k])) return true;
  }
  return false;
}

/// Adds the pair to `found` when it touches; of two balls of one system, only in one order.
void try_pair(const ContactQuery& q, size_t point, uint32_t solid, std::vector<Touch>& found) {
  if (q.own == OwnSolids::yes && q.solids.corners(solid).rows[0] <= point) return;
  const Touch candidate{0, static_cast<uint32_t>(point), solid};
  if (const auto hit = touch_of(q, candidate)) found.push_back({hit->s, candidate.point, solid});
}

}  // namespace

void PointMemory::store(const ConstPoints& start) {
  x_.assign(start.x, start.x + 3 * start.count);
  v_.assign(start.v, start.v + 3 * start.count);
  ids_.assign(start.ids.begin(), start.ids.end());
}

void PointMemory::follow(const ConstPoints& end) {
  align(end);
  free_v_.assign(end.v, end.v + 3 * end.count);
}

void PointMemory::align(const ConstPoints& now) {
  if (std::equal(ids_.begin(), ids_.end(), now.ids.begin(), now.ids.end())) return;
  // Ids ascend in both; what is left keeps its order, so reading stays ahead of
  // writing.
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

const std::vector<Touch>& ContactSearch::run(const ContactQuery& q, SearchRound round,
                                             const ThreadArena& arena) {
  const size_t blocks = (q.count + kBlockPoints - 1) / kBlockPoints;
  if (found_.size() < blocks) found_.resize(blocks);
  if (round == SearchRound::first) {
    look_at_all(q, arena);
  } else {
    look_at_changes(q, arena);
  }
  touches_.clear();
  for (size_t b = 0; b < blocks; ++b) touches_.insert(touches_.end(), found_[b].begin(), found_[b].end());
  std::sort(touches_.begin(), touches_.end(), touch_order);
  return touches_;
}

void ContactSearch::look_at_all(const ContactQuery& q, const ThreadArena& arena) {
  boxes_.resize(q.solids.size());
  arena.for_blocks(boxes_.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) boxes_[i] = box_of_solid(q, i);
  });
  grid_.build(boxes_);
  point_boxes_.resize(q.count);
  arena.for_blocks(q.count, kBlockPoints, [&](size_t begin, size_t end) {
    find_first(q, begin, end, found_[begin / kBlockPoints]);
  });
}

// Untouched points meet touched solids only; touched points meet all, the untouched ones where they were.
void ContactSearch::look_at_changes(const ContactQuery& q, const ThreadArena& arena) {
  changed_.clear(), changed_boxes_.clear();
  for (size_t i = 0; i < boxes_.size(); ++i) {
    if (!touched(q, i)) continue;
    changed_.push_back(static_cast<uint32_t>(i));
    changed_boxes_.push_back(box_of_solid(q, i));
  }
  changed_grid_.build(changed_boxes_);
  arena.for_blocks(q.count, kBlockPoints, [&](size_t begin, size_t end) {
    find_later(q, begin, end, found_[begin / kBlockPoints]);
  });
}

void ContactSearch::find_first(const ContactQuery& q, size_t begin, size_t end, std::vector<Touch>& found) {
  found.clear();
  for (size_t i = begin; i < end; ++i) {
    point_boxes_[i] = box_of_path(q.points, i, q.h);
    grid_.overlapping(point_boxes_[i], [&](uint32_t solid) { try_pair(q, i, solid, found); });
  }
}

void ContactSearch::find_later(const ContactQuery& q, size_t begin, size_t end,
                               std::vector<Touch>& found) const {
  found.clear();
  for (size_t i = begin; i < end; ++i) {
    const bool moved = q.points.traces.touched(i);
    const Box box = moved ? box_of_path(q.points, i, q.h) : point_boxes_[i];
    changed_grid_.overlapping(box, [&](uint32_t k) { try_pair(q, i, changed_[k], found); });
    if (!moved) continue;
    grid_.overlapping(box, [&](uint32_t solid) {
      if (!touched(q, solid)) try_pair(q, i, solid, found);
    });
  }
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

}  // namespace truestep
