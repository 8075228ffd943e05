#include "engine/systems/mpm/implicit_of.h"

namespace truestep::mpm {

template class Implicit<3, 3>;
template class Implicit<3, 4>;

}  // namespace truestep::mpm
