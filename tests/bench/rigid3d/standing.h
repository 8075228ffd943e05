// Rigid bodies in space that should stand, on every available engine.
#pragma once
#include <string>
#include <vector>

#include "tests/bench/rigid3d/engines.h"

namespace truestep::bench {

/// Every scene whose name is in `wanted`; all if it is empty. `rapier` may be null.
void stand(const RapierLibrary* rapier, const std::vector<std::string>& wanted);

}  // namespace truestep::bench
