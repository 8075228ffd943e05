// Rigid bodies in space that should stand, on every engine there is.
#pragma once
#include <string>
#include <vector>

#include "tests/bench/rigid3d/engines.h"

namespace truestep::bench {

/// Every scene whose name is among `wanted`; all where it is empty. `rapier` may be null.
void stand(const RapierLibrary* rapier, const std::vector<std::string>& wanted);

}  // namespace truestep::bench
