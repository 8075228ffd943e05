// The assumptions of a comparison of engines, checked on each of them: axes and sizes of shapes, friction and
// its combination, no bounce, no damping, gravity, masses, sleep, joints. Every check is a small scene with a
// known answer.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "tests/bench/assumption.h"
#include "tests/bench/rigid3d/engines.h"

namespace truestep::bench {

using MakeSpaceEngine = std::function<std::unique_ptr<SpaceEngine>(const SpaceScene&, Sleep)>;
std::vector<Assumption> space_assumptions(const MakeSpaceEngine& make);

}  // namespace truestep::bench
