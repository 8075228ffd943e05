// dopri5 on first-order systems; see explicit_pair.h. A file of its own: eight sizes of it are compiled.
#include "engine/integrators/explicit/explicit_pair.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

void advance_dopri5(Advance& in) {
  advance_pair<kDopri5Tableau>(in, {.q = 5});
}

}  // namespace truestep
