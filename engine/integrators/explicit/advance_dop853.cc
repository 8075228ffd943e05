// dop853 on first-order systems; see explicit_pair.h. Sums are compensated: at the tolerances that this order
// is for, rounding would dominate long runs.
#include "engine/integrators/explicit/explicit_pair.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

void advance_dop853(Advance& in) {
  advance_pair<kDop853Tableau, Sums::compensated, 4, 8, 12>(
      in, {.q = 8, .beta = 0, .safety = 0.9, .shrink = 1.0 / 3, .grow = 6});
}

}  // namespace truestep
