// The Runge-Kutta-Nystroem rows; see nystrom_pair.h.
#include "engine/integrators/explicit/nystrom_pair.h"
#include "engine/integrators/table/methods.h"

namespace truestep {

void advance_rkn86(Advance& in) {
  advance_nystrom<kRkn86Tableau>(in, {.q = 7, .beta = 0, .grow = 6});
}
void advance_rkn1210(Advance& in) {
  advance_nystrom<kRkn1210Tableau>(in, {.q = 11, .beta = 0, .grow = 4});
}

}  // namespace truestep
