// How a method that advances bodies in blocks of its own reports touches on the way (hermite.cc); in the
// workspace. It may leave a step unfinished that has touches, since the step will be repeated.
#pragma once
#include <functional>

#include "engine/systems/nbody/collisions/touches.h"

namespace truestep::nbody {

struct BlockWatch {
  bool on = false;
  std::function<bool(uint32_t, uint32_t)> skip;
  std::vector<Touch> touches;  ///< out, shares of the step
};
inline constexpr std::string_view kBlockWatch = "nbody.block_watch";

}  // namespace truestep::nbody
