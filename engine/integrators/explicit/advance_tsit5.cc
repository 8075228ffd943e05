// tsit5 on first-order systems; see explicit_pair.h.
#include "engine/integrators/explicit/explicit_pair.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

void advance_tsit5(Advance& in) {
  advance_pair<kTsit5Tableau, Sums::plain, 4, 8, 12>(in, {.q = 5});
}

}  // namespace truestep
