// Implicit substeps in space, for both kinds of splines.
#include "engine/systems/mpm/solvers/implicit_of.h"

namespace truestep::mpm {

template class Implicit<3, 3>;
template class Implicit<3, 4>;

}  // namespace truestep::mpm
