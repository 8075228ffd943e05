// Lists of neighbours of f64, in the plane and in space.
#include "engine/systems/sph/lists/neighbour_lists.h"

namespace truestep::sph {

template class Neighbours<2, double>;
template class Neighbours<3, double>;

}  // namespace truestep::sph
