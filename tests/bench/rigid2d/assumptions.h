// The assumptions of a comparison of engines in the plane, checked on each of them (as
// rigid3d/assumptions.h).
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "tests/bench/assumption.h"
#include "tests/bench/rigid2d/engines.h"

namespace truestep::bench {

using MakeFlatEngine = std::function<std::unique_ptr<FlatEngine>(const FlatScene&, Sleep)>;
std::vector<Assumption> flat_assumptions(const MakeFlatEngine& make);

}  // namespace truestep::bench
