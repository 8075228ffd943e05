// Images of a solid in a box that is periodic along some axes: the solid itself, and copies of it whole
// widths of the box away.
#pragma once
#include <cmath>

#include "engine/math/vec3.h"

namespace truestep {

struct Images {
  double period[3] = {};  ///< m, width of the box along axes that repeat the solid; 0 along others

  bool any() const { return period[0] > 0 || period[1] > 0 || period[2] > 0; }

  /// f(shift) for every image whose origin is within `reach` (m, by axis) of a point `way` (m) from the
  /// solid's own, in a fixed order; along axes that do not repeat it for the solid itself, however far.
  template <class F>
  void each(const Vec3& way, const Vec3& reach, const F& f) const {
    if (!any()) return f(Vec3{});
    const double from[3] = {way.x, way.y, way.z}, within[3] = {reach.x, reach.y, reach.z};
    int first[3] = {}, last[3] = {};
    for (int a = 0; a < 3; ++a) {
      if (!(period[a] > 0)) continue;
      first[a] = static_cast<int>(std::ceil((from[a] - within[a]) / period[a]));
      last[a] = static_cast<int>(std::floor((from[a] + within[a]) / period[a]));
    }
    for (int k = first[2]; k <= last[2]; ++k) {
      for (int j = first[1]; j <= last[1]; ++j) {
        for (int i = first[0]; i <= last[0]; ++i) f(Vec3{i * period[0], j * period[1], k * period[2]});
      }
    }
  }
};

}  // namespace truestep
