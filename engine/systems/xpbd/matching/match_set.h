// Groups of points that keep their shape (kernels/xpbd/shape_match.h): the connected components of a body.
#pragma once
#include <vector>

#include "engine/math/mat3.h"
#include "engine/systems/xpbd/body.h"

namespace truestep::xpbd {

struct MatchSet {
  double omega2 = 0;  ///< 1/s^2; HUGE_VAL: rigid
  double linear = 0;
  std::vector<uint32_t> begin;   ///< where each group starts in `points`, and the end
  std::vector<uint32_t> points;  ///< ascending within a group
  std::vector<double> masses;    ///< kg, in the order of `points`
  std::vector<Vec3> rest;        ///< m, relative to the centre of mass, in the order of `points`
  std::vector<Mat3> inverse;     ///< A_qq^-1, 1 / (kg m^2)

  bool empty() const { return points.empty(); }
  size_t groups() const { return inverse.size(); }
  /// Centre and transform of a group from the positions `x(point)`.
  template <class Place>
  std::pair<Vec3, Mat3> goal(size_t group, const Place& x) const;
  /// J, over all points; 0 if rigid.
  double energy(const double* x) const;
};
MatchSet build_matches(const MatchDef& def, const Body& body);

}  // namespace truestep::xpbd
