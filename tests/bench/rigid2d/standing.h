// Rigid bodies in the plane that should stand, on every available engine.
#pragma once
#include <string>
#include <vector>

#include "tests/bench/rigid2d/engines.h"

namespace truestep::bench {

/// Every scene whose name is in `wanted`; all if it is empty.
void stand(const std::vector<FlatLibrary>& libraries, const std::vector<std::string>& wanted);

}  // namespace truestep::bench
