// Groups of points that keep their shape (kernels/xpbd/shape_match.h): whatever hangs together in a body.
#pragma once
#include <vector>

#include "engine/math/mat3.h"
#include "engine/systems/xpbd/body.h"

namespace truestep::xpbd {

struct MatchSet {
  double omega2 = 0;  ///< 1/s^2; HUGE_VAL: rigid
  double linear = 0;
  std::vector<uint32_t> begin;   ///< of every group in points, and the end
  std::vector<uint32_t> points;  ///< ascending within a group
  std::vector<double> masses;    ///< kg, in this order
  std::vector<Vec3> rest;        ///< m, about the centre of mass, in this order
  std::vector<Mat3> inverse;     ///< of A_qq, 1 / (kg m^2)

  bool empty() const { return points.empty(); }
  size_t groups() const { return inverse.size(); }
  /// Centre and transform of a group from the places `x(point)`.
  template <class Place>
  std::pair<Vec3, Mat3> goal(size_t group, const Place& x) const;
  /// J, over all points; 0 where it is rigid.
  double energy(const double* x) const;
};
MatchSet build_matches(const MatchDef& def, const Body& body);

}  // namespace truestep::xpbd
