#include "engine/couplings/contact_search.h"

#include <algorithm>
#include <cmath>

namespace truestep {

namespace {

/// Points that look for solids together: enough to be worth a task, few enough
/// to balance.
constexpr size_t kBlockPoints = 1024;

/// Box around a parabola: both ends, and an eighth of the bend to every side.
void cover_path(Box& box, const MovingPoints& p, size_t row, double h) {
  const Vec3 bend = p.acceleration(row, h) * (0.125 * h * h);
  const Vec3 side{std::fabs(bend.x), std::fabs(bend.y), std::fabs(bend.z)};
  for (const Vec3& at : {p.from(row), load3(p.x, row)}) {
    box.cover(at - side);
    box.cover(at + side);
  }
}

}  // namespace

void PointMemory::store(const ConstPoints& now) {
  x_.assign(now.x, now.x + 3 * now.count);
  v_.assign(now.v, now.v + 3 * now.count);
  ids_.assign(now.ids.begin(), now.ids.end());
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
  touches_.clear();
  const size_t n = q.solids.size();
  boxes_.resize(n);
  arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const SolidList::Corners c = q.solids.corners(i);
      Box box = Box::nothing();
      for (size_t k = 0; k < c.count; ++k) cover_path(box, q.other, c.rows[k], q.h);
      const Vec3 pad{q.reach, q.reach, q.reach};
      boxes_[i] = {box.low - pad, box.high + pad};
    }
  });
  grid_.build(boxes_);

  const size_t blocks = (q.count + kBlockPoints - 1) / kBlockPoints;
  if (found_.size() < blocks) found_.resize(blocks);
  arena.for_blocks(q.count, kBlockPoints, [&](size_t begin, size_t end) {
    find(q, round, begin, end, found_[begin / kBlockPoints]);
  });
  for (size_t b = 0; b < blocks; ++b) touches_.insert(touches_.end(), found_[b].begin(), found_[b].end());
  std::sort(touches_.begin(), touches_.end(), touch_order);
  return touches_;
}

void ContactSearch::find(const ContactQuery& q, SearchRound round, size_t begin, size_t end,
                         std::vector<Touch>& found) const {
  found.clear();
  for (size_t i = begin; i < end; ++i) {
    Box box = Box::nothing();
    cover_path(box, q.points, i, q.h);
    if (!grid_.bounds().overlaps(box)) continue;
    grid_.overlapping(box, [&](uint32_t solid) {
      const SolidList::Corners c = q.solids.corners(solid);
      if (q.own == OwnSolids::yes && c.rows[0] <= i) return;
      bool changed = q.points.traces.touched(i);
      for (size_t k = 0; k < c.count; ++k) changed = changed || q.other.traces.touched(c.rows[k]);
      if (round == SearchRound::later && !changed) return;
      const Touch candidate{0, static_cast<uint32_t>(i), solid};
      if (const auto hit = touch_of(q, candidate)) found.push_back({hit->s, candidate.point, solid});
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
