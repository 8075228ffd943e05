// Long-range attachments (Kim, Chentanez, Mueller 2012, "Long range attachments - a method to simulate
// inextensible clothing in computer games"): a free point gets no further from the held point that is nearest
// along the links than that way is long at rest,
//   |x - x_a| <= L (1 + slack),
// whatever iterations have left of the links between. They are limits, not springs, and move the free point
// alone.
#pragma once
#include <vector>

#include "engine/systems/xpbd/body.h"

namespace truestep::xpbd {

struct Tether {
  uint32_t point, anchor;
  double length;  ///< m
};

/// One for every free point from which links lead to a pin, ascending.
std::vector<Tether> build_tethers(const Body& body, double slack);

}  // namespace truestep::xpbd
