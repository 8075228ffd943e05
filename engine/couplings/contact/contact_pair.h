// A point and the corners of a solid, as seen by an impulse between them: u = v_p - sum b_i v_i changes by du
// through J = du / K on the point and -b_i J on the corners, K = w_p + sum b_i^2 w_i.
#pragma once
#include "engine/couplings/contact/contact_search.h"

namespace truestep::contact {

struct ContactPair {
  size_t point;
  SolidList::Corners corners;
  HullWeights b;
  double w;                     ///< 1/kg of the point
  std::array<double, 3> share;  ///< b_i w_i
  double k;                     ///< K; 0: both are held

  ContactPair(const Points& p, const Points& o, uint32_t point_row, const SolidList::Corners& c,
              const HullWeights& weights)
      : point(point_row), corners(c), b(weights), w(p.inverse_mass(point_row)), share{}, k(w) {
    for (size_t i = 0; i < c.count; ++i) {
      share[i] = b[i] * o.inverse_mass(c.rows[i]);
      k += b[i] * share[i];
    }
  }
  /// Value at the point minus the blend of the values at the corners; arrays are n x 3.
  Vec3 relative(const double* of_points, const double* of_other) const {
    Vec3 u = load3(of_points, point);
    for (size_t i = 0; i < corners.count; ++i) u -= load3(of_other, corners.rows[i]) * b[i];
    return u;
  }
  /// Changes the relative value by `by`, keeping the mass-weighted sum.
  void change(double* of_points, double* of_other, const Vec3& by) const {
    const Vec3 j = by / k;
    store3(of_points, point, load3(of_points, point) + j * w);
    for (size_t i = 0; i < corners.count; ++i) {
      const size_t row = corners.rows[i];
      store3(of_other, row, load3(of_other, row) - j * share[i]);
    }
  }
};

}  // namespace truestep::contact
