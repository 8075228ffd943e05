// Members in the order of a grid's slots, and what one of them sums up over its neighbours after Reynolds.
// Neighbours are first listed, four candidates at a time and without a branch, since most of them are none;
// sums follow the list's order, which is that of the slots.
#pragma once
#include <cstdint>
#include <vector>

#include "engine/math/lanes.h"
#include "engine/neighbours/point_grid.h"

namespace truestep::flocking {

/// Candidates that are looked at together.
inline constexpr size_t kAtOnce = 4;

struct Sorted {
  PointGrid grid;
  std::vector<double> v;           ///< n x 3
  std::vector<double> xs, ys, zs;  ///< n, and room to read four at a time
  std::vector<double> x4, v4;      ///< n x 4, the last one 0

  /// Velocities as n x 3 only.
  void build(const double* x, const double* velocities, size_t n, double reach);
  /// All of it.
  void build_wide(const double* x, const double* velocities, size_t n, double reach);
};

/// Squares of radii (m^2), the radius of separation (m), and the cosine of half of the angle of view.
struct Sight {
  double reach2, align2, join2, apart, cos_view;
  enum class Field : uint8_t { all, cone } field = Field::all;
};

/// Sums over neighbours: d of their places, differences of their velocities, pushes away from them.
class Gather {
 public:
  Gather(const Sorted& sorted, const Sight& sight) : sorted_(sorted), sight_(sight) {}

  /// Begins anew, for the member in a slot.
  void begin(size_t slot, const Vec3& heading);
  /// Looks from another place than the member's own from here on: from an image of it.
  void look_from(const Vec3& p);
  /// Those of the slots [from, to) that p, where it looks from, sees; the member itself among them.
  void add(const Vec3& p, size_t from, size_t to);
  /// To be called last.
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
