// Soft things of springs, of constraints and of finite elements, whose stiffness and density are drawn over
// several powers of ten.
#pragma once
#include <boost/json.hpp>
#include <cstdint>
#include <vector>

#include "engine/math/vec3.h"
#include "tests/stability/campaign/dice.h"

namespace truestep::campaign {

/// A soft system about the origin, within `reach` m of it, at the height 0 where bodies can fall on it.
struct SoftThing {
  boost::json::object system;
  double mass;            ///< kg, of all of it
  double link;            ///< m, between neighbours, about
  double top, low;        ///< m, above the origin and, of what is below it, its height
  std::vector<int> ends;  ///< points that bodies are tied to
  Vec3 end;               ///< m, where the first of them is
};

enum class Soft : uint8_t {
  xpbd_cloth,
  xpbd_rope,
  xpbd_block,
  fem_block,
  fem_sheet,
  spring_cloth,
  spring_rope,
  spring_net
};
/// The stiffest are this many times as stiff as those that bodies are joined to.
SoftThing soft(Dice& d, Soft kind, double stiffer = 1);

}  // namespace truestep::campaign
