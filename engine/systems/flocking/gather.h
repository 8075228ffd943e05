// Members in the order of a grid's slots, and the sums over a member's neighbours in Reynolds' rule.
// Neighbours are first listed, four candidates at a time and branch-free, since most candidates are not
// neighbours; sums follow the list's order, which is that of the slots.
#pragma once
#include <cstdint>
#include <vector>

#include "engine/math/lanes.h"
#include "engine/neighbours/point_grid.h"

namespace truestep::flocking {

/// Candidates tested together.
inline constexpr size_t kAtOnce = 4;

struct Sorted {
  PointGrid grid;
  std::vector<double> v;           ///< n x 3
  std::vector<double> xs, ys, zs;  ///< n, and room to read four at a time
  std::vector<double> x4, v4;      ///< n x 4, the last one 0

  /// Positions and velocities as n x 3 only.
  void build(const double* x, const double* velocities, size_t n, double reach, const ThreadArena& arena);
  /// All layouts.
  void build_wide(const double* x, const double* velocities, size_t n, double reach,
                  const ThreadArena& arena);
};

/// Squares of radii (m^2), the radius of separation (m), and the cosine of half of the angle of view.
struct Sight {
  double reach2, align2, join2, apart, cos_view;
  enum class Field : uint8_t { all, cone } field = Field::all;
};

/// Sums over neighbours: relative positions, relative velocities, and pushes away from them.
class Gather {
 public:
  Gather(const Sorted& sorted, const Sight& sight) : sorted_(sorted), sight_(sight) {}

  /// Starts over, for the member in a slot.
  void begin(size_t slot, const Vec3& heading);
  /// From here on looks from another position than the member's own: an image of it.
  void look_from(const Vec3& p);
  /// Adds those of the slots [from, to) seen from p, the present viewpoint; includes the member itself.
  void add(const Vec3& p, size_t from, size_t to);
  /// Call last.
  void finish();

  Vec3 away, mean_v, mean_x;
  double with = 0, near = 0;

 private:
  void sum();
  static constexpr size_t kList = 64;
  const Sorted& sorted_;
  const Sight& sight_;
  size_t count_ = 0;
  Vec3 heading_;
  Lanes4 u_, at_, away_, v_, x_;
  uint32_t list_[kList + kAtOnce];
};

}  // namespace truestep::flocking
