// dopri5 on first-order systems; see explicit_pair.h.
#include "engine/integrators/explicit/explicit_pair.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

void advance_dopri5(Advance& in) {
  advance_pair<kDopri5Tableau, Sums::plain, 2, 4, 8, 12>(in, {.q = 5});
}

}  // namespace truestep
