#include "engine/systems/sph/neighbour_lists.h"

namespace truestep::sph {

template class Neighbours<2, double>;
template class Neighbours<3, double>;

}  // namespace truestep::sph
