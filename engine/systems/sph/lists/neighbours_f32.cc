// Lists of neighbours of f32, in the plane and in space.
#include "engine/systems/sph/lists/neighbour_lists.h"

namespace truestep::sph {

template class Neighbours<2, float>;
template class Neighbours<3, float>;

}  // namespace truestep::sph
