// Surface tension. `cohesion`: pairs attract each other (kernels/sph/cohesion.h); a particle at the surface
// lacks neighbours on one side and is drawn in, pressure maintains the density. `interface`: the surface has
// an energy (kernels/sph/interface.h). Walls do not attract: drops bead on them. A force from the colour
// field's curvature (Brackbill, Kothe & Zemach 1992) was tried: the normals of particles that leave the
// surface are noise, and fed energy to drops until they burst.
#pragma once
#include "engine/systems/sph/fluid.h"

namespace truestep::sph {

/// Adds `strength` sum C(|x_ij| / H) x_ji / |x_ij| to f.a (m/s^2).
template <int D, class T>
void draw_together(Fluid<D, T>& f, T strength, T support, const ThreadArena& arena);
/// Adds the forces of the interface's energy to f.a; `strength` = e / (H m) (m/s^2).
template <int D, class T>
void shrink_interface(Fluid<D, T>& f, T strength, const PlaneInterface& plane, T support,
                      const ThreadArena& arena);

}  // namespace truestep::sph
