// Moves points towards the goals of their groups, group by group.
#pragma once
#include <vector>

#include "engine/base/parallel.h"
#include "engine/systems/xpbd/matching/match_goal.h"

namespace truestep::xpbd {

class MatchSolver {
 public:
  void prepare(const MatchSet& set, bool keeps) { lambda_.assign(keeps ? set.points.size() : 0, Vec3{}); }
  void forget_multipliers() { std::fill(lambda_.begin(), lambda_.end(), Vec3{}); }
  /// Rows of four (solver.h), relative to positions `start`; h in s.
  template <class T>
  void solve(const MatchSet& set, const double* start, double h, T relax, T* rows, const ThreadArena& arena) {
    const auto place = [&](uint32_t p) {
      const T* r = rows + 4 * size_t{p};
      return load3(start, p) + Vec3{r[0], r[1], r[2]};
    };
    arena.for_blocks(set.groups(), 4, [&](size_t first, size_t last) {
      for (size_t g = first; g < last; ++g) {
        const auto [centre, turn] = set.goal(g, place);
        for (uint32_t e = set.begin[g]; e < set.begin[g + 1]; ++e) {
          const uint32_t p = set.points[e];
          T* r = rows + 4 * size_t{p};
          const double w = r[3], soft = match_softness(set.omega2, set.masses[e], h);
          if (!(w > 0)) continue;
          Vec3 to = centre + turn * set.rest[e] - place(p);
          if (!lambda_.empty()) to = to - lambda_[e] * soft;
          const Vec3 step = to / (w + soft);
          if (!lambda_.empty()) lambda_[e] += step;
          const Vec3 by = step * (w * double{relax});
          r[0] += static_cast<T>(by.x), r[1] += static_cast<T>(by.y), r[2] += static_cast<T>(by.z);
        }
      }
    });
  }

 private:
  std::vector<Vec3> lambda_;  // kg m
};

}  // namespace truestep::xpbd
