#include "engine/systems/sph/neighbour_lists.h"

namespace truestep::sph {

template class Neighbours<2, float>;
template class Neighbours<3, float>;

}  // namespace truestep::sph
