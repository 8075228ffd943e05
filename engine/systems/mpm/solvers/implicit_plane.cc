// Implicit substeps in the plane, for both kinds of splines.
#include "engine/systems/mpm/solvers/implicit_of.h"

namespace truestep::mpm {

template class Implicit<2, 3>;
template class Implicit<2, 4>;

}  // namespace truestep::mpm
