// Rigid bodies in the plane that should stand, on every engine there is.
#pragma once
#include <string>
#include <vector>

#include "tests/bench/rigid2d/engines.h"

namespace truestep::bench {

/// Every scene whose name is among `wanted`; all where it is empty.
void stand(const std::vector<FlatLibrary>& libraries, const std::vector<std::string>& wanted);

}  // namespace truestep::bench
