// Whether bodies of a scene may sleep, by each engine's own rules and thresholds.
#pragma once

namespace truestep::bench {

enum class Sleep { never, allowed };

}  // namespace truestep::bench
