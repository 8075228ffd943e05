#include "engine/systems/mpm/implicit_of.h"

namespace truestep::mpm {

template class Implicit<2, 3>;
template class Implicit<2, 4>;

}  // namespace truestep::mpm
