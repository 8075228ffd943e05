#include "engine/couplings/contact/near_pairs.h"

#include <algorithm>
#include <cmath>

namespace truestep::contact {

namespace {

/// Margin of every box as a fraction of the solids' mean width: small compared with the boxes' usual overlap.
constexpr double kMargin = 0.05;

}  // namespace

void NearPairs::widen() {
  double sum = 0, count = 0;
  for (const Box& b : solids) {
    const Vec3 e = b.high - b.low;
    const double w = std::max({e.x, e.y, e.z});
    if (std::isfinite(w)) sum += w, count += 1;
  }
  const double m = count > 0 ? kMargin * sum / count : 0;
  const Vec3 margin{m, m, m};
  for (std::vector<Box>* boxes : {&points, &solids}) {
    for (Box& b : *boxes) b.low -= margin, b.high += margin;
  }
}

}  // namespace truestep::contact
