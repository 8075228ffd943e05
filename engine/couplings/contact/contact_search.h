// Which points touch which solids during a substep: boxes around the paths of the solids, sorted into a grid,
// then the first contact of every point's path with the solids near it.
#pragma once
#include <algorithm>
#include <optional>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/core/ports/ports.h"
#include "engine/couplings/contact/near_pairs.h"
#include "engine/kernels/contact/point_hull.h"

namespace truestep::contact {

/// Positions of points at the substep's start, and the velocities that the systems alone have given them by
/// its end.
class PointMemory {
 public:
  void store(const ConstPoints& start);
  /// After the systems' step of h: follows rows that moved. A new point starts where it is; if points have no
  /// ids, it was split off another (cloth that tears) and already has its velocity.
  void follow(const ConstPoints& end, double h);
  const double* x() const { return x_.data(); }
  const double* v() const { return v_.data(); }
  const double* free_v() const { return free_v_.data(); }

 private:
  void align(const ConstPoints& now);
  void add_split(const ConstPoints& now, double h);

  std::vector<double> x_, v_, free_v_;
  std::vector<uint64_t> ids_;
};

/// Changes to the rows of one side by the answers of a substep: the rest of a touched row's path begins where
/// and when it was last touched.
class RowTraces {
 public:
  /// For `rows` rows, none touched.
  void prepare(size_t rows) {
    if (since_.size() < rows) since_.resize(rows, kUntouched), round_.resize(rows);
    if (end_.size() < 3 * rows) end_.resize(3 * rows), from_.resize(3 * rows);
  }
  bool touched(size_t row) const { return since_[row] >= 0; }
  /// Fraction of the substep at which the rest of the path begins.
  double since(size_t row) const { return touched(row) ? since_[row] : 0; }
  Vec3 from(size_t row) const { return load3(from_.data(), row); }
  /// n x 3, for touched rows: the velocity (m/s) at the substep's end if only the acceleration had acted.
  double* end() { return end_.data(); }
  Vec3 end(size_t row) const { return load3(end_.data(), row); }
  void touch(size_t row, double s, const Vec3& place, const Vec3& free_velocity, uint32_t round) {
    if (!touched(row)) store3(end_.data(), row, free_velocity);
    store3(from_.data(), row, place);
    since_[row] = s;
    round_[row] = round;
  }
  /// Whether the row was last answered in that round.
  bool touched_in(size_t row, uint32_t round) const { return touched(row) && round_[row] == round; }
  void forget(size_t row) { since_[row] = kUntouched; }

 private:
  static constexpr double kUntouched = -1;
  std::vector<double> since_, end_, from_;
  std::vector<uint32_t> round_;
};

/// One side of a contact: its points now and at the substep's start, and the touches in between.
struct MovingPoints {
  const double *x, *v;
  const PointMemory& memory;
  RowTraces& traces;

  /// m/s^2, averaged over the substep without any impacts, including those of other couplings.
  Vec3 acceleration(size_t row, double h) const {
    return ((traces.touched(row) ? traces.end(row) : free_velocity(row)) - load3(memory.v(), row)) / h;
  }
  Vec3 free_velocity(size_t row) const { return load3(memory.free_v(), row); }
  /// Where the row's path begins.
  Vec3 from(size_t row) const { return traces.touched(row) ? traces.from(row) : load3(memory.x(), row); }
  /// The parabola from there to the present position with that acceleration, over s in [since, 1].
  HullPath path(size_t row, double h) const {
    const double since = traces.since(row), rest = 1 - since;
    // Touched at the very end: it stays in place.
    if (!(rest > 1e-12)) return {load3(x, row), {}, {}};
    const Vec3 a = acceleration(row, h) * (h * h), begin = from(row);
    const Vec3 slope = (load3(x, row) - begin) / rest - a * (0.5 * rest), v0 = slope - a * since;
    return {begin - v0 * since - a * (0.5 * since * since), v0, a};
  }
};

/// The solids of a system, numbered: triangles, then segments, then balls.
struct SolidList {
  PublishedSolids solids;
  size_t balls = 0;  ///< rows that are balls: all or none

  size_t size() const { return solids.triangles.size() + solids.segments.size() + balls; }
  struct Corners {
    std::array<uint32_t, 3> rows;
    size_t count;
  };
  Corners corners(size_t i) const {
    if (i < solids.triangles.size()) return {solids.triangles[i], 3};
    i -= solids.triangles.size();
    if (i < solids.segments.size()) {
      const auto& s = solids.segments[i];
      return {{s[0], s[1], s[1]}, s[0] == s[1] ? 1u : 2u};
    }
    const auto row = static_cast<uint32_t>(i - solids.segments.size());
    return {{row, row, row}, 1};
  }
};

/// A point touching a solid, first at fraction s of the substep.
struct Touch {
  double s;
  uint32_t point, solid;
};

inline bool touch_order(const Touch& a, const Touch& b) {
  if (a.s != b.s) return a.s < b.s;
  return a.point != b.point ? a.point < b.point : a.solid < b.solid;
}

enum class OwnSolids : uint8_t { no, yes };
/// Input of a search: points, the solids of `other` (the same system: OwnSolids::yes, each pair once), the
/// distance (m) at which they touch, the substep's length (s).
struct ContactQuery {
  MovingPoints points;
  size_t count;
  MovingPoints other;
  size_t other_count;
  SolidList solids;
  OwnSolids own;
  double reach, h;
};

/// First contact of the pair on its present paths; empty when it does not touch.
std::optional<HullContact> touch_of(const ContactQuery& q, const Touch& t);

class ContactSearch {
 public:
  /// All touches in round 0, later those on paths changed by the answers of the last round; by time, then
  /// point, then solid.
  const std::vector<Touch>& run(const ContactQuery& q, uint32_t round, const ThreadArena& arena);
  /// The pairs that were examined.
  NearPairs& near() { return near_; }

 private:
  void find_pairs(const ContactQuery& q, const ThreadArena& arena);
  void look_at_all(const ContactQuery& q, const ThreadArena& arena);
  void look_at_changes(const ContactQuery& q, uint32_t last, const ThreadArena& arena);
  template <class Due>
  void look_at_pairs(const ContactQuery& q, const ThreadArena& arena, Due&& due);

  NearPairs near_;
  std::vector<HullPath> corners_;          // of all rows on the solids' side
  std::vector<uint8_t> changed_;           // solids
  std::vector<std::vector<Touch>> found_;  // per block of points
  std::vector<Touch> touches_;
};

}  // namespace truestep::contact
