#include "engine/integrators/explicit/drive.h"

namespace truestep {

template void drive(Advance& in, AdaptiveMethod& method, const step_control::Law& law);

}  // namespace truestep
