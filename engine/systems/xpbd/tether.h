// Long-range attachments (Kim, Chentanez, Mueller 2012, "Long range attachments - a method to simulate
// inextensible clothing in computer games"): a free point stays within the rest length of the shortest path
// along links to its nearest held point,
//   |x - x_a| <= L (1 + slack),
// however far the links between have converged. These are limits, not springs, and move the free point alone.
#pragma once
#include <vector>

#include "engine/systems/xpbd/body.h"

namespace truestep::xpbd {

struct Tether {
  uint32_t point, anchor;
  double length;  ///< m
};

/// One for every free point that links connect to a pin, ascending.
std::vector<Tether> build_tethers(const Body& body, double slack);

}  // namespace truestep::xpbd
